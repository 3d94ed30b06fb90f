"""A sweep from its plan to table and plot."""

from __future__ import annotations

import pickle
import signal
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from pfemcut.inputs import InputError, nearest
from pfemcut.launcher import under_mpirun
from pfemcut.method import RunStopped
from pfemcut.output.directory import HISTORY, writing
from pfemcut.output.progress import duration
from pfemcut.ranks import Ranks
from pfemcut.results.summary import Summary
from pfemcut.sweep.display import LOG, display
from pfemcut.sweep.plan import Plan
from pfemcut.sweep.pool import Command, Ended, run_pool
from pfemcut.sweep.prepare import Prepared, State, advice, changes, prepared, require_unchanged, states
from pfemcut.sweep.results import CSV, JSON, Outcome, outcomes_of, print_results, write_results
from pfemcut.sweep.units import units_of
from pfemcut.sweep.worker import Task, run_task

Say = Callable[[str], None]


class SweepStopped(RunStopped):
    """A sweep of which not all variants finished; what did not goes on when it is called again."""


def run_sweep(plan: Plan, jobs: int, *, overwrite: bool, say: Say) -> None:
    """Run what is not finished, a few variants at a time, then write table and plot.

    Parameters
    ----------
    plan
        The sweep.
    jobs
        Number of processes.
    overwrite
        Whether variants whose case changed start anew.
    say
        Prints a line.

    Raises
    ------
    InputError, OutputError
        Before anything starts: if a case is wrong, or a folder holds the run of another case.
    SweepStopped
        At the end, if a variant did not finish, or after a signal.
    """
    _conclude(plan, outcomes_of(run_variants(plan, jobs, overwrite=overwrite, say=say)), say)


def run_variants(plan: Plan, jobs: int, *, overwrite: bool, say: Say) -> tuple[Prepared, ...]:
    """Run what is not finished, without table and plot; parameters and errors as of :func:`run_sweep`.

    A variant that did not finish raises nothing here: see :func:`require_finished`.
    """
    require_no_launcher()
    variants = prepared(plan)
    if not overwrite:
        require_unchanged(variants)
    _say_state(plan, variants, states(variants), say)
    begun = time.monotonic()
    ran = run_unfinished(variants, jobs, overwrite=overwrite)
    if ran:
        took = duration(time.monotonic() - begun)
        say(f"ran {ran} variants in {took}, {min(jobs, ran)} at a time")
    return variants


def require_no_launcher() -> None:
    """Raise :class:`InputError` under mpirun, whose ranks would each start the processes of a study."""
    if under_mpirun():
        raise InputError(
            ["a study starts its own processes: call it without mpirun (one variant of a sweep with --index)"]
        )


def run_unfinished(variants: Sequence[Prepared], jobs: int, *, overwrite: bool) -> int:
    """Run what is not finished, a few variants at a time; how many were run.

    Raises
    ------
    SweepStopped
        After a signal.
    """
    before = states(variants)
    todo = [each for each, state in zip(variants, before, strict=True) if state is not State.FINISHED]
    ended = _run_all(todo, min(jobs, len(todo)), overwrite=overwrite)
    if ended.signal:
        name, after = signal.Signals(ended.signal).name, states(variants)
        left = [each for each, state in zip(variants, after, strict=True) if state is not State.FINISHED]
        raise SweepStopped(
            f"stopped by {name}, {len(variants) - len(left)} of {len(variants)} variants finished; the same command "
            f"goes on with {', '.join(str(each.directory) for each in left) or 'the tables'}"
        )
    return len(todo)


def require_finished(outcomes: Sequence[Outcome]) -> None:
    """Raise :class:`SweepStopped`, with their names, if some did not finish."""
    missing = [each for each in outcomes if not each.finished]
    if missing:
        texts = [f"{each.variant.directory} {each.status}" for each in missing]
        raise SweepStopped(f"{len(missing)} of {len(outcomes)} variants did not finish: {', '.join(texts)}")


def listed(variants: Sequence[Prepared]) -> list[str]:
    """Number, name and state of each variant, then what ``pfemcut check`` warns of."""
    width = max(len(variant.name) for variant in variants)
    lines = [
        f"{index:>4}  {variant.name:<{width}}  {state.value}"
        for index, (variant, state) in enumerate(zip(variants, states(variants), strict=True))
    ]
    return [*lines, *(f"warning: {text}" for text in advice(variants))]


def run_one(variant: Prepared, *, overwrite: bool, say: Say) -> Summary | None:
    """Run one variant in this process (or these, under MPI) as ``pfemcut run`` does; None if it was finished."""

    def todo() -> list[Task]:
        if not overwrite:
            require_unchanged([variant])
        (state,) = states([variant])
        return [] if state is State.FINISHED else [_task(variant, overwrite=overwrite)]

    # Rank 0 decides: the others might look when it has already begun to write.
    for task in Ranks().on_first(todo):
        return run_task(task)
    say(f"{variant.name}: finished before")
    return None


def collect(plan: Plan, say: Say) -> None:
    """Write table and plot of what is there; raises :class:`SweepStopped` if not all of it is finished."""
    _conclude(plan, outcomes_of(prepared(plan)), say)


def chosen(variants: Sequence[Prepared], only: str | None, index: int | None) -> Prepared:
    """The variant of this name or number.

    Raises
    ------
    InputError
        If there is none.
    """
    if only is not None:
        known = {variant.name: variant for variant in variants}
        if only not in known:
            raise InputError([f"--only: unknown variant '{only}'{nearest(only, known)}"])
        return known[only]
    if index is None or not 0 <= index < len(variants):
        raise InputError([f"--index: given {index}, must be from 0 to {len(variants) - 1}"])
    return variants[index]


def _run_all(todo: Sequence[Prepared], jobs: int, *, overwrite: bool) -> Ended:
    commands = [
        Command(
            name=each.name,
            arguments=(sys.executable, "-m", "pfemcut.sweep.worker"),
            given=pickle.dumps(_task(each, overwrite=overwrite)),
            log=each.directory / LOG,
        )
        for each in todo
    ]
    with display(todo) as shown:
        return run_pool(commands, jobs, shown)


def _task(variant: Prepared, *, overwrite: bool) -> Task:
    """Its run; only one whose folder holds another case begins anew there."""
    return Task(variant, overwrite=overwrite and bool(changes(variant)), arguments=tuple(sys.argv))


def _say_state(plan: Plan, variants: Sequence[Prepared], before: Sequence[State], say: Say) -> None:
    counts = [f"{before.count(state)} {state.value}" for state in State if before.count(state)]
    say(f"{len(variants)} variants in {plan.output}: {', '.join(counts)}")
    for each in variants:
        for text in changes(each):
            say(f"{each.name}: starts anew, {text}")
    known = {each.name for each in variants}
    left = sorted(
        folder.parent.name for folder in plan.output.glob(f"*/{HISTORY}") if folder.parent.name not in known
    )
    if left:
        say(f"not of this sweep, left alone: {', '.join(left)}")


def _conclude(plan: Plan, outcomes: Sequence[Outcome], say: Say) -> None:
    # Not before it's needed: matplotlib takes a second to load.
    from pfemcut.sweep.plot import write_plot

    with writing(plan.output):
        write_results(plan, outcomes)
        units = units_of(outcomes[0].variant.case, plan.keys)
        plots: list[Path] = write_plot(plan, outcomes, units)
    print_results(plan, outcomes)
    for path in (plan.output / CSV, plan.output / JSON, *plots):
        say(str(path))
    require_finished(outcomes)
