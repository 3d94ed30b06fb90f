"""The driver: runs any method to its end and writes everything that a user gets.

It knows methods by :class:`pfemcut.method.Method` alone, so history, fields, checkpoints, progress, figures and
reports are written once and serve every method.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pfemcut.any_problem import AnyProblem
from pfemcut.conclusion import summary_of
from pfemcut.inputs import UserError
from pfemcut.method import CutEnded, Frame, Measures, Method, RunStopped
from pfemcut.moment import Callback, Callbacks, Moment, nothing
from pfemcut.output.directory import (
    SUMMARY,
    prepare_directory,
    remove_conclusions,
    writing,
)
from pfemcut.output.progress import progress_display
from pfemcut.output.recorder import Recorder
from pfemcut.output.requests import Request, asked, done
from pfemcut.problem import Cut
from pfemcut.ranks import Ranks, RanksDiffer, SignalNotes
from pfemcut.results.checkpoint import (
    Checkpoint,
    State,
    read_checkpoint,
    require_same_case,
    require_still_cutting,
)
from pfemcut.results.contact_table import EVERY
from pfemcut.results.derived.columns import derived_columns
from pfemcut.results.derived.tool_profiles import tool_loads
from pfemcut.results.summary import Summary, write_summary

if TYPE_CHECKING:
    from pfemcut.case.load import AnyCase, AnyMaterial


class RunInterrupted(RunStopped):
    """A run stopped by a signal; it can be resumed."""


class _CallbackStopped(Exception):
    """A callback asked to stop."""


class _CallbackFailed(Exception):
    """A callback raised ``error``; the state is that of a finished step and worth keeping."""

    def __init__(self, error: Exception) -> None:
        self.error = error
        super().__init__(f"a callback raised {type(error).__name__}: {error}")


class OutputControls(Protocol):
    """How often what is written (steps); ``case.output`` is one."""

    @property
    def every(self) -> int:
        """Steps between frames of the fields."""

    @property
    def history_every(self) -> int:
        """Steps between history rows."""

    @property
    def checkpoint_every(self) -> int:
        """Steps between checkpoints."""

    @property
    def figures(self) -> bool:
        """Whether figures and the report are made at the end."""


@dataclass(frozen=True)
class MethodFactory:
    """Makes a method: from the problem's initial state, or from a checkpoint's state."""

    start: Callable[[], Method]
    restore: Callable[[State], Method]


def run_case(
    case: AnyCase,
    material: AnyMaterial,
    directory: Path | str,
    *,
    base_directory: Path = Path(),
    resume: bool = False,
    overwrite: bool = False,
    callbacks: Callbacks = Callbacks(),  # noqa: B008 (frozen)
) -> Summary:
    """Run a case with its method and return its summary; see :func:`run_problem`."""
    from pfemcut.case.load import resolved_toml
    from pfemcut.case.translate import problem_of
    from pfemcut.methods import factory_of

    # Files that the case names need to be on the first rank's machine only.
    problem = Ranks().on_first(lambda: problem_of(case, material, base_directory))
    inputs = resolved_toml(case, material)
    return run_problem(
        problem,
        factory_of(problem),
        Path(directory),
        case.output,
        inputs=inputs,
        resume=resume,
        overwrite=overwrite,
        callbacks=callbacks,
    )


def run_problem(
    problem: AnyProblem,
    factory: MethodFactory,
    directory: Path,
    controls: OutputControls,
    *,
    inputs: str,
    resume: bool = False,
    overwrite: bool = False,
    callbacks: Callbacks = Callbacks(),  # noqa: B008 (frozen)
    communicator: Any = None,
) -> Summary:
    """Run a method to its end; under MPI called by all ranks, of which the first writes.

    Parameters
    ----------
    problem
        What is run; its title, tool, cut and final time are used here.
    factory
        Makes the method.
    directory
        Output directory.
    controls
        How often what is written.
    inputs
        Resolved case (TOML text), kept beside the results and in checkpoints.
    resume
        Go on from the checkpoint in ``directory``.
    overwrite
        Let a fresh run remove the results of an earlier one in ``directory``.
    callbacks
        Called before and after each step. One that stops the run, or raises, leaves what a signal leaves.
    communicator
        An mpi4py communicator; the world if None.

    Returns
    -------
    The summary, also of a cut that came to a physical end before its travel.

    Raises
    ------
    RunStopped
        If the method can't go on, or (:class:`RunInterrupted`) on SIGINT, SIGTERM, SIGUSR1 or a
        request (:mod:`pfemcut.output.requests`). Outputs and a checkpoint
        of the last finished step are written, and a summary that says ``finished: false``. After
        :class:`pfemcut.ranks.RanksDiffer` the last checkpoint is that of an earlier step.
    OutputError, CheckpointError
        If the directory can't be used, or there is nothing that could be resumed.
    """
    ranks = Ranks(communicator)
    with ranks.together():
        ranks.on_first(lambda: prepare_directory(directory, resume=resume, overwrite=overwrite))
        # What was asked of an earlier run, which ended before it came to it.
        ranks.on_first(lambda: done(directory, *Request))
        last_step = -1
        warnings: tuple[str, ...] = ()
        if resume:
            checkpoint = ranks.on_first(lambda: _resumable(directory, inputs))
            last_step, warnings = checkpoint.step, checkpoint.warnings
            method = factory.restore(checkpoint.state)
            require_still_cutting(checkpoint.resolved_case, inputs, method.measure().time)
            # What an earlier end concluded no longer holds; a resume that was refused left it.
            ranks.on_first(lambda: remove_conclusions(directory))
        else:
            method = factory.start()
        run = _Run(problem, method, directory, controls, ranks, warnings, callbacks)
        with run.recording(inputs, last_step):
            return run.to_end(fresh=not resume)


class _Run:
    """A method on its way through the loop, and what is written on the way."""

    def __init__(
        self,
        problem: AnyProblem,
        method: Method,
        directory: Path,
        controls: OutputControls,
        ranks: Ranks,
        warnings: Sequence[str],
        callbacks: Callbacks,
    ) -> None:
        self._callbacks = callbacks
        self._problem = problem
        self._method = method
        self._directory = directory
        self._controls = controls
        self._ranks = ranks
        self._warnings = tuple(warnings)
        # Rank 0 has one, the others none.
        self._recorders: list[Recorder] = []
        # The last step's measures, until they stand in the history.
        self._pending: list[Measures] = []

    @contextmanager
    def recording(self, inputs: str, last_step: int) -> Iterator[None]:
        """Open the writers, and close them whatever happens."""
        opened = self._recorders
        self._ranks.on_first(lambda: opened.append(Recorder(self._directory, inputs, last_step)))
        try:
            yield
        finally:
            for recorder in opened:
                recorder.close()

    def to_end(self, *, fresh: bool) -> Summary:
        """Advance until the method is finished, can't go on, or a signal comes."""
        method = self._method
        try:
            if fresh:
                self._record_frame(self._method.frame())
            course = self._problem.course
            with SignalNotes() as signals, progress_display(course, visible=self._ranks.first) as progress:
                while not method.finished:
                    self._call(self._callbacks.before_step)
                    begun = time.perf_counter()
                    measures = self._advance()
                    self._record(measures, begun)
                    progress.show(measures)
                    self._call(self._callbacks.after_step)
                    self._obey(measures, self._ranks.largest(signals.noted))
        except CutEnded as ended:
            return self._finish(finished=True, ending=str(ended), warnings=(str(ended),))
        except RanksDiffer:
            raise  # no state that is worth keeping
        except _CallbackFailed as failed:
            self._finish(finished=False, ending=str(failed), warnings=(str(failed),))
            raise failed.error from None
        except _CallbackStopped as stopped:
            return self._finish(finished=False, ending=str(stopped), warnings=(str(stopped),))
        except RunStopped as stopped:
            self._finish(finished=False, ending=str(stopped), warnings=(str(stopped),))
            raise
        return self._finish(finished=True, ending="reached its final time")

    def _call(self, callback: Callback) -> None:
        """Call a callback of the user; its wish to stop is followed, and its error told, on all ranks."""
        if callback is nothing:
            return
        moment, errors = Moment(self._method), []
        try:
            callback(moment)
        except Exception as error:
            errors.append(error)
        self._ranks.require_same(errors, "in a callback")
        for failure in errors:
            raise _CallbackFailed(failure)
        if self._ranks.largest(int(bool(moment.stop_reason))) and not self._method.finished:
            raise _CallbackStopped(f"stopped by a callback: {moment.stop_reason or 'on another rank'}")

    def _obey(self, measures: Measures, number: int) -> None:
        """Do what was asked for during a step, by the signal of that number or by requests in the directory."""
        requests = self._ranks.on_first(lambda: asked(self._directory))
        if Request.CHECKPOINT in requests:
            self._record_checkpoint(measures.step)
        if requests:
            self._ranks.on_first(lambda: done(self._directory, *requests))
        by = signal.Signals(number).name if number else "a request"
        if (number or Request.STOP in requests) and not self._method.finished:
            raise RunInterrupted(
                f"stopped by {by} after step {measures.step}, "
                f"travel {measures.travel:.4f} mm; it can be resumed"
            )

    def _advance(self) -> Measures:
        """Advance one step, to which all ranks must come to the same outcome; its measures, or its error."""
        outcome: Measures | Exception
        try:
            self._method.advance()
            outcome = self._method.measure()
        except (RunStopped, CutEnded, UserError) as ended:
            outcome = ended
        self._ranks.require_same(outcome, "in a step")
        if isinstance(outcome, Exception):
            raise outcome
        return outcome

    def _record(self, measures: Measures, begun: float) -> None:
        """Write what is due after a step; the time that this takes is the step's phase ``output``."""
        method, controls, step = self._method, self._controls, measures.step
        advanced = time.perf_counter()
        self._pending = [measures]
        if step % controls.history_every == 0:
            self._record_row()
        if step % controls.every == 0 or self._problem.ends_stage(measures.time):
            self._record_frame(method.frame())
        if step % controls.checkpoint_every == 0:
            self._record_checkpoint(step)
        ended = time.perf_counter()
        seconds = {**method.timing(), "output": ended - advanced, "total": ended - begun}
        self._ranks.on_first(lambda: self._recorders[0].times(step, seconds))

    def _record_row(self) -> None:
        """Write the history row of the last step, unless it is written."""
        for measures in self._pending:
            own = dict(self._method.own_measures())
            frames = [self._method.frame()] if self._problem.cut else []
            cuts = zip(frames, self._problem.cut, strict=False)

            def write_row(
                measures: Measures = measures,
                own: dict[str, float] = own,
                cuts: Iterable[tuple[Frame, Cut]] = cuts,
            ) -> None:
                for frame, cut in cuts:
                    own.update(derived_columns(frame, cut))
                    # A tool that withdraws has other loads than that of the cut.
                    if measures.step % EVERY == 0 and self._problem.cutting_at(measures.time):
                        self._record_contact(frame, cut, measures.dt)
                self._recorders[0].row(measures, own)

            self._ranks.on_first(write_row)
        self._pending = []

    def _record_contact(self, frame: Frame, cut: Cut, last_dt: float) -> None:
        """Write what the tool's surface feels; a rigid tool's forces act on lengths of the begin of the step."""
        (tool,) = self._problem.tool
        loads = tool_loads(frame, (-cut.speed, 0.0), 0.0 if tool.body else last_dt)
        self._recorders[0].contact(frame.step, loads)

    def _record_frame(self, frame: Frame) -> None:
        self._ranks.on_first(lambda: self._recorders[0].frame(frame))

    def _record_checkpoint(self, step: int) -> None:
        state = self._method.state()
        self._ranks.on_first(lambda: self._recorders[0].checkpoint(step, state))

    def _finish(self, *, finished: bool, ending: str, warnings: Sequence[str] = ()) -> Summary:
        """Write the last state, the summary, and the figures and the report if wished."""
        self._record_row()
        frame = self._method.frame()
        # Before the fields: whoever asked for the end may kill soon.
        self._record_checkpoint(frame.step)
        self._record_frame(frame)

        def conclude() -> Summary:
            directory, every = self._directory, (*self._warnings, *warnings)
            summary = summary_of(directory, self._problem, finished=finished, ending=ending, warnings=every)
            with writing(directory):
                write_summary(directory / SUMMARY, summary)
                if self._controls.figures:
                    # Not before it's needed: matplotlib takes a second to load.
                    from pfemcut.output.report import write_report

                    write_report(directory)
            return summary

        return self._ranks.on_first(conclude)


def _resumable(directory: Path, inputs: str) -> Checkpoint:
    checkpoint = read_checkpoint(directory)
    require_same_case(checkpoint.resolved_case, inputs)
    return checkpoint
