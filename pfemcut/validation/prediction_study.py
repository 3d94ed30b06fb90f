"""Predictions of a set of measured cuts: the runs, and what follows from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from pfemcut.validation.prediction import PlannedCut, load_measurements, numerical_parts, predicted
from pfemcut.validation.prediction_tables import write_predictions, write_sensitivities
from pfemcut.validation.study import Outcome, Study, Variant
from pfemcut.whole_files import finite

MESH_RATIO = 2.0**0.5
"""By which the coarser mesh is coarser."""
STEP_RATIO = 2.0
"""By which the longer steps are longer."""
COARSE = "mesh_coarse"
LONG = "step_long"


class CutChanges(Protocol):
    """What a cut changes in its set's case."""

    def __call__(
        self, cut: PlannedCut, mesh_factor: float = 1.0, step_factor: float = 1.0
    ) -> tuple[str, ...]:
        """Changes (``section.key=value``) with sizes and steps times the factors."""


@dataclass(frozen=True)
class CutAgain:
    """A run of a cut as it is predicted, but for what is ``different`` and its travel (mm)."""

    name: str
    cut: PlannedCut
    different: tuple[str, ...]
    travel: float


@dataclass(frozen=True)
class PredictedSet:
    """A set of cuts that were measured and are predicted.

    One of them is repeated with a coarser mesh and with longer steps, for the uncertainty of all; with the coarser mesh
    other choices show what they move.

    Attributes
    ----------
    folder
        Its demo folder, with ``case.toml`` and ``measured.toml``.
    material
        For titles.
    cuts
        The cuts in the order of the table.
    base
        The one that is repeated.
    changes
        What a cut changes in the case.
    travels
        Travel of each cut (mm), by name.
    choices
        Changes of the sensitivities, by name.
    again
        Cuts that are run again with other changes.
    """

    folder: Path
    material: str
    cuts: tuple[PlannedCut, ...]
    base: PlannedCut
    changes: CutChanges
    travels: Mapping[str, float]
    choices: Mapping[str, tuple[str, ...]]
    again: tuple[CutAgain, ...] = ()

    def study(self) -> Study:
        """The runs in their order, and how they are concluded."""
        return Study(
            "predict",
            self.folder,
            (
                *(Variant(cut.name, self.changes(cut), self.travels[cut.name]) for cut in self.cuts),
                self._repeated(COARSE, self.changes(self.base, mesh_factor=MESH_RATIO)),
                self._repeated(LONG, self.changes(self.base, step_factor=STEP_RATIO)),
                *(
                    self._repeated(name, (*self.changes(self.base, mesh_factor=MESH_RATIO), *different))
                    for name, different in self.choices.items()
                ),
                *(
                    Variant(again.name, (*self.changes(again.cut), *again.different), again.travel)
                    for again in self.again
                ),
            ),
            self.conclude,
            travel=self.travels[self.base.name],
            case=self.folder / "case.toml",
            partial=True,
        )

    def conclude(self, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
        """Tables and plot of the runs that are there; shown if all cuts are."""
        runs = {outcome.variant.name: outcome for outcome in outcomes}
        figures = {name: predicted(outcome, self.base.depth) for name, outcome in runs.items()}
        parts = {
            name: numerical_parts(figures.get(self.base.name), figures.get(other), ratio)
            for name, other, ratio in (("mesh", COARSE, MESH_RATIO), ("step", LONG, STEP_RATIO))
        }
        content = write_predictions(
            results / "predict.csv",
            f"{self.material}: predicted and measured",
            self.cuts,
            runs,
            tuple(parts.values()),
            load_measurements(self.folder / "measured.toml"),
        )
        content["relative_uncertainty"] = {
            name: {figure: finite(value) for figure, value in part.items()} for name, part in parts.items()
        }
        content |= write_sensitivities(
            results / "sensitivities.csv",
            f"{self.material}: what moves it",
            {
                **dict.fromkeys((COARSE, LONG), (self.base.name, self.base)),
                **dict.fromkeys(self.choices, (COARSE, self.base)),
                **{again.name: (again.cut.name, again.cut) for again in self.again},
            },
            runs,
        )
        return content, not content["not_run"]

    def _repeated(self, name: str, changes: tuple[str, ...]) -> Variant:
        return Variant(name, changes, self.travels[self.base.name])
