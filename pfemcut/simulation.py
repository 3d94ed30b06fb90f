"""Run cases from scripts and notebooks: to the end with files, or step by step in memory."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.fields import Fields
from pfemcut.inputs import UserError
from pfemcut.loaded_case import LoadedCase, load_case
from pfemcut.method import CutEnded, Measures, Method
from pfemcut.moment import Callback, Callbacks, Moment, nothing

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Results:
    """What a run left in its directory; also of a run that is going on or stopped.

    Attributes
    ----------
    directory
        The output directory.
    """

    directory: Path

    @property
    def summary(self) -> dict[str, Any]:
        """The content of ``summary.json``: each figure with its unit, ``finished``, ``warnings`` and so on."""
        path = self.directory / "summary.json"
        try:
            return dict(json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError) as error:
            raise UserError(f"{path}: can't be read ({error})") from None

    @property
    def finished(self) -> bool:
        """Whether the run came to its end."""
        return bool(self.summary["finished"])

    @property
    def history(self) -> dict[str, Array]:
        """The columns of ``history.csv`` by name, each of shape (rows,); units: s, mm, N/mm, K, mJ/mm."""
        from pfemcut.results.history import read_table

        path = self.directory / "history.csv"
        if not path.is_file():
            raise UserError(f"{path}: no such file")
        return read_table(path)

    @property
    def steps(self) -> tuple[int, ...]:
        """Steps of which the fields are kept (``[output] every``)."""
        from pfemcut.output.vtu import read_collection

        return tuple(sorted({entry.step for entry in read_collection(self.directory)}))

    def fields(self, step: int | None = None) -> Fields:
        """Read the fields of one of ``steps``, the last unless given."""
        from pfemcut.output.vtu import read_collection, read_frame

        steps = self.steps
        if not steps or (step is not None and step not in steps):
            raise UserError(f"{self.directory}: no fields of step {step}; there are {list(steps)}")
        wanted = steps[-1] if step is None else step
        entries = [entry for entry in read_collection(self.directory) if entry.step == wanted]
        return Fields(read_frame(self.directory, entries))


def run(
    case: LoadedCase | Path | str,
    directory: Path | str | None = None,
    *,
    before_step: Callback = nothing,
    after_step: Callback = nothing,
    resume: bool = False,
    overwrite: bool = False,
) -> Results:
    """Run a case to its end and write what ``pfemcut run`` writes.

    Parameters
    ----------
    case
        A loaded case or a case file.
    directory
        Output directory; the case's unless given.
    before_step, after_step
        Called with a :class:`pfemcut.Moment` (measures, fields) before and after each step; ``moment.stop("why")``
        stops the run so that it can be resumed. An error that they raise ends the run so too, and is raised again.
    resume
        Go on from the last checkpoint in ``directory``.
    overwrite
        Replace the results of an earlier run in ``directory``.

    Raises
    ------
    UserError
        If the case or the directory can't be used.
    RunStopped
        If the run can't go on, or was interrupted (Ctrl-C or the notebook's stop button); what it did is written.
    """
    from pfemcut.case.load import directed
    from pfemcut.driver import run_case

    loaded = case if isinstance(case, LoadedCase) else load_case(case)
    folder = Path(loaded.case.output.directory if directory is None else directory)
    with _same_matplotlib():
        run_case(
            directed(loaded.case, folder),
            loaded.material,
            folder,
            base_directory=loaded.directory,
            resume=resume,
            overwrite=overwrite,
            callbacks=Callbacks(before_step, after_step),
        )
    return Results(folder)


class Simulation:
    """A run in memory, one step at a time; nothing is written unless :meth:`save` is called.

    Parameters
    ----------
    case
        A loaded case or a case file.
    checkpoint
        Go on from this file, or the newest checkpoint of this folder, of a run of the same case; only the travel,
        outputs and wear constants may differ.
    """

    def __init__(self, case: LoadedCase | Path | str, checkpoint: Path | str | None = None) -> None:
        from pfemcut.methods import factory_of

        self.case = case if isinstance(case, LoadedCase) else load_case(case)
        self._problem = self.case.problem()
        self._rows: list[dict[str, Any]] = []
        self._ending = ""
        factory = factory_of(self._problem)
        self._method: Method = (
            factory.start() if checkpoint is None else factory.restore(self._state_in(Path(checkpoint)))
        )

    def _state_in(self, path: Path) -> Any:
        from pfemcut.results.checkpoint import read_checkpoint, read_file, require_same_case

        found = read_checkpoint(path) if path.is_dir() else read_file(path)
        require_same_case(found.resolved_case, self.case.toml())
        return found.state

    @property
    def finished(self) -> bool:
        """Whether the travel is reached, or the cut came to a physical end before it (see ``ending``)."""
        return bool(self._ending) or self._method.finished

    @property
    def ending(self) -> str:
        """Why the cut ended before its travel or was stopped; empty if it wasn't."""
        return self._ending

    @property
    def measures(self) -> Measures:
        """Time (s), travel (mm), forces on the tool (N/mm), temperatures (K), energies (mJ/mm) after the last step."""
        return self._method.measure()

    @property
    def fields(self) -> Fields:
        """The fields after the last step."""
        return Fields(self._method.frame())

    @property
    def history(self) -> dict[str, Array]:
        """What ``history.csv`` would hold of the steps made here, by column; each of shape (steps,)."""
        names = self._rows[0] if self._rows else ()
        return {name: np.array([row[name] for row in self._rows], dtype=np.float64) for name in names}

    def step(self) -> Measures:
        """Advance one step and return the measures after it.

        At a physical end of the cut the state stays, and ``finished`` and ``ending`` tell.

        Raises
        ------
        RunStopped
            If the run can't go on; the state stays that of the last finished step.
        UserError
            If it is finished.
        """
        from pfemcut.results.derived.columns import derived_columns
        from pfemcut.results.history import history_row

        if self.finished:
            raise UserError(f"the simulation is finished{': ' + self._ending if self._ending else ''}")
        try:
            self._method.advance()
        except CutEnded as ended:
            self._ending = str(ended)
            return self.measures
        measures, own = self.measures, dict(self._method.own_measures())
        for cut in self._problem.cut:
            own.update(derived_columns(self._method.frame(), cut))
        self._rows.append(history_row(measures, own))
        return measures

    def run(
        self,
        *,
        steps: int | None = None,
        travel: float | None = None,
        before_step: Callback = nothing,
        after_step: Callback = nothing,
    ) -> Measures:
        """Advance until the case's end, or as far as asked.

        Parameters
        ----------
        steps
            At most this many steps.
        travel
            Until the first step at which the tool has travelled this far (mm).
        before_step, after_step
            Called with a :class:`pfemcut.Moment`, which can stop here. The simulation can go on afterwards.
        """
        done = 0
        while not self.finished:
            if (steps is not None and done >= steps) or (
                travel is not None and self.measures.travel >= travel
            ):
                break
            moment = Moment(self._method)
            before_step(moment)
            if moment.stop_reason:
                break
            self.step()
            done += 1
            after_step(moment)
            if moment.stop_reason:
                break
        return self.measures

    def save(self, path: Path | str) -> None:
        """Write a checkpoint file, which ``Simulation(case, checkpoint=path)`` goes on from."""
        from pfemcut.output.directory import writing
        from pfemcut.results.checkpoint import write_checkpoint

        path = Path(path)
        with writing(path.parent):
            write_checkpoint(path, self._method.state(), self.case.toml(), self.measures.step)


@contextmanager
def _same_matplotlib() -> Iterator[None]:
    """Keep matplotlib's backend, a notebook's own: the figures of a run are drawn with one for files."""
    before = sys.modules["matplotlib"].get_backend() if "matplotlib" in sys.modules else None
    try:
        yield
    finally:
        if before is not None:
            sys.modules["matplotlib"].use(before)
