"""Runs one variant: in this process, or as the process of its own that the pool starts.

``python -m pfemcut.sweep.worker`` reads a pickled :class:`Task` from standard input: the validated case itself, so
that a case file edited while a sweep goes on changes nothing. Its exit statuses are those of ``pfemcut run``.
"""

from __future__ import annotations

import fcntl
import os
import pickle
import signal
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from pfemcut.inputs import UserError
from pfemcut.method import RunStopped
from pfemcut.output.directory import OutputError, writing
from pfemcut.results.summary import Summary
from pfemcut.sweep.prepare import Prepared


@dataclass(frozen=True)
class Task:
    """A variant to run.

    Attributes
    ----------
    variant
        The variant.
    overwrite
        Whether it starts anew on what its folder holds; else it goes on from the checkpoint, if there is one.
    arguments
        The sweep's command line, for the record.
    """

    variant: Prepared
    overwrite: bool
    arguments: tuple[str, ...]


def run_task(task: Task) -> Summary:
    """Run the variant into its folder; under MPI called by all ranks.

    Raises
    ------
    RunStopped
        As :func:`pfemcut.driver.run_case` does.
    UserError
        Likewise, and if another process runs this variant.
    """
    from pfemcut.ranks import Ranks
    from pfemcut.validation.recorded_run import Start, record_case

    variant, ranks = task.variant, Ranks()
    held = ranks.on_first(lambda: _claim(variant.directory))
    try:
        start = Start(resume=not task.overwrite, overwrite=task.overwrite)
        return record_case(variant.case, variant.material, variant.directory, start, variant.base_directory)
    finally:
        if ranks.first:
            os.close(held)


def _claim(directory: Path) -> int:
    """Lock the folder against another process that would run the same variant; the lock's descriptor."""
    with writing(directory):
        directory.mkdir(parents=True, exist_ok=True)
        held = os.open(directory, os.O_RDONLY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(held)
        raise OutputError(f"{directory}: another process is running this variant") from None
    except OSError:
        pass  # A file system without locks: nothing guards it.
    return held


def _stop_when_alone() -> None:
    """Stop, with a checkpoint, when the process that holds the other end of standard input is gone."""

    def watch() -> None:
        # Not sys.stdin: its lock, held at the end of the program, would crash it.
        while os.read(0, 1):
            pass
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=watch, daemon=True).start()


def main() -> int:
    """Run the task on standard input; the exit status."""
    try:
        task: Task = pickle.load(sys.stdin.buffer)
        sys.argv[:] = task.arguments
        _stop_when_alone()
        summary = run_task(task)
    except KeyboardInterrupt:
        print("interrupted before the first step", file=sys.stderr)
        return 130
    except UserError as error:
        print(error, file=sys.stderr)
        return 2
    except RunStopped as error:
        print(f"run stopped: {error}", file=sys.stderr)
        return 1
    print(summary.ending)
    return 0 if summary.finished else 1


if __name__ == "__main__":
    sys.exit(main())
