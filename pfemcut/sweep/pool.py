"""A few processes side by side: started as places come free, all stopped by one signal."""

from __future__ import annotations

import contextlib
import os
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pfemcut.output.directory import writing
from pfemcut.ranks import SignalNotes

POLL = 0.1
"""Seconds between looks at the processes."""

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
"""Runs side by side share the cores best with one thread each, and are then the same bit for bit."""


@dataclass(frozen=True)
class Command:
    """A process to run.

    Attributes
    ----------
    name
        Its name.
    arguments
        Program and arguments.
    given
        What it finds on standard input, which stays open until it ends.
    log
        File that its output is appended to.
    """

    name: str
    arguments: tuple[str, ...]
    given: bytes
    log: Path


class Watcher:
    """What the pool tells; this one says nothing."""

    def started(self, name: str) -> None:
        """Note that a process was started."""

    def ended(self, name: str, status: int) -> None:
        """Note that a process ended, with its exit status (minus the signal's number if one killed it)."""

    def stopping(self) -> None:
        """Note that a signal came, which is now handed on."""

    def passing(self, running: Sequence[str]) -> None:
        """Note that time passes."""


@dataclass(frozen=True)
class Ended:
    """What a pool did.

    Attributes
    ----------
    statuses
        Exit statuses of the processes that were started.
    signal
        Number of the signal that stopped the pool; zero if none did.
    """

    statuses: Mapping[str, int]
    signal: int


def run_pool(commands: Sequence[Command], jobs: int, watcher: Watcher) -> Ended:
    """Run the commands, ``jobs`` at a time, in their order.

    SIGINT or SIGTERM is handed on to all of them, once, and waits for their end; nothing more is started. A second
    signal kills.
    """
    waiting = list(commands)
    running: dict[str, subprocess.Popen[bytes]] = {}
    statuses: dict[str, int] = {}
    told = False
    with SignalNotes() as signals:
        try:
            while running or (waiting and not signals.noted):
                while waiting and len(running) < jobs and not signals.noted:
                    command = waiting.pop(0)
                    running[command.name] = _started(command)
                    watcher.started(command.name)
                if signals.noted and not told:
                    told = True
                    watcher.stopping()
                    for process in running.values():
                        process.send_signal(signals.noted)
                time.sleep(POLL)
                for name, process in list(running.items()):
                    if (status := process.poll()) is not None:
                        statuses[name] = status
                        _closed(running.pop(name))
                        watcher.ended(name, status)
                watcher.passing(tuple(running))
        finally:
            for process in running.values():
                process.kill()
                process.wait()
                _closed(process)
        return Ended(statuses, signals.noted)


def _started(command: Command) -> subprocess.Popen[bytes]:
    with writing(command.log.parent):
        command.log.parent.mkdir(parents=True, exist_ok=True)
        log = command.log.open("ab")
    with log:
        process = subprocess.Popen(
            command.arguments,
            env={**os.environ, **ONE_THREAD},
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=subprocess.STDOUT,
            # A terminal's Ctrl-C reaches it through us, once: a second signal would kill it before its checkpoint.
            start_new_session=True,
        )
    assert process.stdin is not None
    # A process that died at once doesn't read; its status tells.
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(command.given)
        process.stdin.flush()
    return process


def _closed(process: subprocess.Popen[bytes]) -> None:
    assert process.stdin is not None
    # What it never read can't be delivered any more.
    with contextlib.suppress(BrokenPipeError):
        process.stdin.close()
