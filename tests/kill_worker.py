"""Runs of the driver that die, or find the disk full or read-only, at a chosen call to the operating system.

    python kill_worker.py FOLDER EVENT FIRST STRIDE

Counts the calls of open, write, flush, fsync, rename, remove and mkdir that concern files of a run, and at FIRST,
FIRST + STRIDE and so on, and in one checkpoint at each, in a process of its own, lets EVENT happen: ``kill`` (before
the call; half of the bytes of a write are written first), or ``full`` and ``readonly`` (it and all later ones fail).
Then the newest checkpoint must be no older than the last that was completed, the run must resume and leave what
an undisturbed one leaves. Prints what is wrong, one line each, and at the end the number of calls tried.
"""

from __future__ import annotations

import builtins
import errno
import io
import os
import shutil
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from test_driver import Controls, run

from pfemcut.inputs import UserError
from pfemcut.output import recorder
from pfemcut.results.checkpoint import NAME, PREVIOUS, read_checkpoint, write_checkpoint

DIRECTORY, CALL, EVENT = Path("/nowhere"), 0, ""
CHECKPOINT_CALLS = slice(10, 18)
"""Of the calls that concern checkpoints, those that are always tried: the third one's among them."""
ERRORS = {"full": errno.ENOSPC, "readonly": errno.EROFS}

calls = 0
of_checkpoints: list[int] = []


def reached(path: object) -> bool:
    """Whether this is the call at which it happens; calls outside of the directory don't count."""
    global calls
    if not str(path).startswith(str(DIRECTORY)):
        return False
    calls += 1
    if Path(str(path)).name.startswith("checkpoint"):
        of_checkpoints.append(calls)
    return calls == CALL or (EVENT in ERRORS and CALL and calls > CALL)


def happen(path: object) -> None:
    if EVENT == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    raise OSError(ERRORS[EVENT], os.strerror(ERRORS[EVENT]), str(path))


def guarded(
    function: Callable[..., Any], path_of: Callable[..., object] = lambda path, *_: path
) -> Callable[..., Any]:
    def call(*arguments: Any, **options: Any) -> Any:
        path = path_of(*arguments)
        if reached(path):
            happen(path)
        return function(*arguments, **options)

    return call


class Writer:
    """A file opened for writing, whose writes and flushes are calls too."""

    def __init__(self, file: Any) -> None:
        self._file = file

    def write(self, data: Any) -> int:
        if reached(self._file.name):
            self._file.write(data[: len(data) // 2])
            if EVENT == "kill":
                self._file.flush()
            happen(self._file.name)
        return int(self._file.write(data))

    def flush(self) -> None:
        if reached(self._file.name):
            happen(self._file.name)
        self._file.flush()

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def __iter__(self) -> Any:
        return iter(self._file)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


def opened(path: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
    writes = isinstance(path, str | os.PathLike) and any(letter in mode for letter in "wax+")
    if writes and reached(Path(path).absolute()):
        happen(path)
    file = original_open(path, mode, *arguments, **options)
    return Writer(file) if writes and str(Path(path).absolute()).startswith(str(DIRECTORY)) else file


original_open = io.open


def install() -> None:
    """Put the counting calls in place of the system's."""
    builtins.open = io.open = opened  # type: ignore[assignment]
    os.fsync = guarded(os.fsync, lambda at: os.readlink(f"/proc/self/fd/{at}"))
    for name in ("replace", "rename", "unlink", "remove", "mkdir", "rmdir"):
        setattr(os, name, guarded(getattr(os, name), lambda path, *_: Path(os.fspath(path)).absolute()))

    def noting(path: Path, state: Any, case: str, step: int) -> None:
        write_checkpoint(path, state, case, step)
        (DIRECTORY.parent / "completed").write_text(str(step))

    recorder.write_checkpoint = noting


def has_checkpoint(directory: Path) -> bool:
    return any((directory / name).exists() for name in (NAME, PREVIOUS))


def child(folder: Path, event: str, number: int) -> tuple[int, str]:
    """Run in ``folder`` in a process of its own; its exit status (or minus the signal) and what it printed."""
    global DIRECTORY, CALL, EVENT
    sys.stdout.flush()
    said = folder / "said"
    process = os.fork()
    if process:
        status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        return status, said.read_text()
    status = 70
    try:
        DIRECTORY, CALL, EVENT = folder / "run", number, event
        os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)
        install()
        resume = has_checkpoint(DIRECTORY)
        controls = Controls(every=3, checkpoint_every=2)
        run(DIRECTORY, last=12, resume=resume, overwrite=DIRECTORY.exists() and not resume, controls=controls)
        print(*of_checkpoints, calls)
        status = 0
    except UserError as error:
        print(error)
        status = 2
    except BaseException:
        traceback.print_exc(file=sys.stdout)
    finally:
        sys.stdout.flush()
        os._exit(status)


RESULTS = ("history.csv", "contact.csv", "tool_profiles.csv", "inputs.resolved.toml")


def results(directory: Path) -> dict[str, bytes]:
    frames = sorted(path for path in (directory / "fields").iterdir() if path.suffix == ".vtu")
    return {path.name: path.read_bytes() for path in (*(directory / name for name in RESULTS), *frames)}


def wrong_after(folder: Path, event: str, number: int, whole: dict[str, bytes]) -> str:
    """What is wrong after ``event`` at call ``number``; nothing if all is well."""
    status, said = child(folder, event, number)
    lines = said.splitlines()
    if event == "kill" and status != -signal.SIGKILL:
        return f"ended with {status}: {said}"
    if event != "kill" and (status != 2 or "can't be written" not in lines[-1] or "Traceback" in said):
        return f"no clear error, but {status}: {said}"
    completed = folder / "completed"
    if completed.exists():
        try:
            found = read_checkpoint(folder / "run")
        except UserError as error:
            return str(error)
        if found.step < int(completed.read_text()) or found.warnings:
            return (
                f"checkpoint of step {found.step} {found.warnings}, but {completed.read_text()} was completed"
            )
    status, said = child(folder, "none", 0)
    if status:
        return f"can't go on ({status}): {said}"
    if results(folder / "run") != whole:
        return "the results differ"
    return ""


def main() -> None:
    folder, event, first, stride = (
        Path(sys.argv[1]).resolve(),
        sys.argv[2],
        int(sys.argv[3]),
        int(sys.argv[4]),
    )
    (folder / "whole").mkdir()
    *checkpoints, count = map(int, child(folder / "whole", "none", 0)[1].splitlines()[-1].split())
    whole = results(folder / "whole/run")
    tried = 0
    for number in sorted({*range(first, count + 1, stride), *checkpoints[CHECKPOINT_CALLS]}):
        made = folder / str(number)
        made.mkdir()
        wrong = wrong_after(made, event, number, whole)
        if wrong:
            print(f"call {number} of {count}: {wrong}")
        shutil.rmtree(made)
        tried += 1
    print(tried)


if __name__ == "__main__":
    main()
