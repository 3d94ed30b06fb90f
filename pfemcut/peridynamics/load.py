"""Constants of laminae: their schema, the library, and the way from a case file to :class:`Lamina` and back."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, Strict, ValidationError, model_validator

from pfemcut.input_table import InputTable
from pfemcut.inputs import InputError, explained
from pfemcut.library import entry, entry_names
from pfemcut.peridynamics.lamina import Lamina

PACKAGE = "pfemcut.peridynamics"
SECTION = "lamina.material"


class LaminaTable(InputTable):
    """Constants of a unidirectional lamina of springs, which has nu_12 = 1/3 and G_12 = Q22 / 3."""

    name: str = Field(default="", description="Name for reports")
    source: str = Field(default="", description="Where the constants come from")
    notes: Annotated[tuple[str, ...], Strict(False)] = Field(default=(), description="What a user must know")
    axial_modulus: float = Field(gt=0, description="Young's modulus along the fibre, E1 (MPa)")
    transverse_modulus: float = Field(gt=0, description="Young's modulus across the fibre, E2 (MPa)")
    density: float = Field(gt=0, lt=1e-6, description="Density (tonne/mm³)")
    opening_energy: float = Field(
        gt=0, description="Energy release rate of cracks along the fibre, mode I (N/mm)"
    )
    shear_energy: float = Field(gt=0, description="Likewise in mode II (N/mm)")
    fibre_energy: float = Field(
        default=90.0, gt=0, description="Energy release rate of cracks across the fibres (N/mm)"
    )

    @model_validator(mode="after")
    def _is_stiffer_along_the_fibre(self) -> Self:
        if self.axial_modulus < self.transverse_modulus:
            raise ValueError(
                f"axial_modulus: given {self.axial_modulus:g}, must not be less than transverse_modulus = "
                f"{self.transverse_modulus:g}"
            )
        return self


def lamina_names() -> list[str]:
    """Names of the library's laminae."""
    return entry_names(PACKAGE)


def lamina_table(spec: str | Mapping[str, Any], base_directory: Path) -> dict[str, Any]:
    """The table of constants that a case file asks for, checked and complete.

    Parameters
    ----------
    spec
        A library name, a path to a TOML file (relative ones start at ``base_directory``), or a table, which may take
        the others from the library by ``base``.
    base_directory
        Folder of the case file.

    Raises
    ------
    InputError
        If there are no such constants or they are not valid.
    """
    if isinstance(spec, str):
        table, origin = _named(spec, base_directory)
    else:
        table, origin = dict(spec), ""
        base = table.pop("base", None)
        if base is not None:
            table = {**_named(str(base), base_directory)[0], **table}
    try:
        found = LaminaTable.model_validate(table).model_dump()
    except ValidationError as error:
        problems = explained(error, LaminaTable, "" if origin else SECTION)
        raise InputError(f"{origin}: {line}" if origin else line for line in problems) from None
    return {**found, "notes": list(found["notes"])}


def lamina_of(table: Mapping[str, Any]) -> Lamina:
    """The lamina of a table of constants (:func:`lamina_table`)."""
    given = LaminaTable.model_validate(dict(table))
    return Lamina(
        given.name or "unnamed",
        given.axial_modulus,
        given.transverse_modulus,
        given.density,
        given.opening_energy,
        given.shear_energy,
        given.fibre_energy,
    )


def _named(name: str, base_directory: Path) -> tuple[dict[str, Any], str]:
    """Table of the library or of a file, and what messages call it."""
    table, path = entry(PACKAGE, name, base_directory, "[lamina] material", "lamina")
    return table, f"lamina '{name}'" if name in lamina_names() else str(path)
