"""A case in a script or notebook: loaded from a file or a table, changed, checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pfemcut.case.load import AnyCase, AnyMaterial, CaseError, replaced, resolved_toml, validated
from pfemcut.inputs import InputError, read_toml

if TYPE_CHECKING:
    from pfemcut.any_problem import AnyProblem


@dataclass(frozen=True)
class LoadedCase:
    """A validated case with its material.

    Attributes
    ----------
    case
        The case file's sections, e.g. ``case.cutting.speed`` (mm/s).
    material
        The (first) body's material.
    directory
        Folder in which files that the case names are looked for.
    """

    case: AnyCase
    material: AnyMaterial
    directory: Path

    def figures(self) -> dict[str, str]:
        """Main figures with their units, as ``pfemcut check`` prints them."""
        from pfemcut.case.check import figures

        return dict(figures(self.case, self.material, self.directory))

    def warnings(self) -> list[str]:
        """Choices that are allowed but unwise, as ``pfemcut check`` prints them."""
        from pfemcut.case.check import warnings

        return warnings(self.case, self.material, self.directory)

    def toml(self) -> str:
        """The whole case with all defaults, as a case file."""
        return resolved_toml(self.case, self.material)

    def problem(self) -> AnyProblem:
        """The problem that methods solve."""
        from pfemcut.case.translate import problem_of

        return problem_of(self.case, self.material, self.directory)


def load_case(
    source: Path | str | Mapping[str, Any],
    changes: Mapping[str, Any] | None = None,
    *,
    directory: Path | str | None = None,
) -> LoadedCase:
    """Load and validate a case.

    Parameters
    ----------
    source
        A case file, or a table of the same shape (``{"workpiece": {"length": 2.5, ...}, ...}``). Units: mm, tonne, s,
        K; angles in degrees.
    changes
        Values that replace those of ``source``, by ``"section.key"``: ``{"cutting.travel": 0.1}``.
    directory
        Folder in which files that the case names are looked for: that of the case file unless given, or for a table the
        current one.

    Raises
    ------
    CaseError
        With one line for each problem found; a :class:`pfemcut.UserError`.
    """
    if isinstance(source, Mapping):
        table, home = dict(source), Path()
    else:
        try:
            table, home = read_toml(Path(source)), Path(source).parent
        except CaseError:
            raise
        except InputError as error:
            raise CaseError(error.problems) from None
    for key, value in (changes or {}).items():
        table = replaced(table, key.split("."), value, f"load_case: given '{key}'")
    folder = home if directory is None else Path(directory)
    return LoadedCase(*validated(table, folder), folder)
