"""What a callback sees of a run, and how it can stop it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pfemcut.method import Measures, Method

if TYPE_CHECKING:
    from pfemcut.fields import Fields


class Moment:
    """A run between two steps.

    Parameters
    ----------
    method
        The method in the middle of its run.
    """

    def __init__(self, method: Method) -> None:
        self._method = method
        self._reason = ""

    @property
    def measures(self) -> Measures:
        """Time (s), travel (mm), forces on the tool (N/mm), temperatures (K), energies (mJ/mm) after the last step."""
        return self._method.measure()

    @property
    def own_measures(self) -> Mapping[str, float]:
        """Further columns of ``history.csv`` that the method has."""
        return self._method.own_measures()

    @property
    def fields(self) -> Fields:
        """The fields now; computed when asked for."""
        from pfemcut.fields import Fields

        return Fields(self._method.frame())

    def stop(self, reason: str = "a callback asked for it") -> None:
        """Stop the run here; it can be resumed. Under mpirun one rank's wish is enough."""
        self._reason = reason or "no reason given"

    @property
    def stop_reason(self) -> str:
        """Why the run is to stop; empty if it isn't."""
        return self._reason


Callback = Callable[[Moment], object]


def nothing(_: Moment) -> None:
    """Do nothing."""


@dataclass(frozen=True)
class Callbacks:
    """What is called before and after each step. Under mpirun all ranks call them, and must do the same."""

    before_step: Callback = nothing
    after_step: Callback = nothing
