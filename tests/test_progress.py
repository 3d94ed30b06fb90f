"""The progress display: plain lines when not a terminal, not too many, and a fair time to go."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from test_history import MEASURES

from pfemcut.output.progress import Live, PlainLines, duration, progress_display, remaining
from pfemcut.problem.course import straight


def test_plain_lines_come_every_few_seconds_and_at_the_end() -> None:
    # The run was resumed at 50 of 150: what came before is no measure of the pace.
    now = [0.0]
    stream = io.StringIO()
    with PlainLines(straight(150.0), stream=stream, interval=5.0, clock=lambda: now[0]) as lines:
        for second in range(12):
            now[0] = float(second)
            lines.show(replace(MEASURES, step=second, time=50.0 + second))
    text = stream.getvalue().splitlines()
    assert [line.split("step ")[1].split()[0] for line in text] == ["0", "5", "10", "11"]
    assert text[-1].endswith("to go 0:01:29")
    for needed in ("travel 0.0003 mm", "Fc 120.0", "Ft 40.0", "Tmax 293 K"):
        assert needed in text[-1]


def test_lines_become_rare_in_a_long_run() -> None:
    """A day in steps of ten seconds: every minute after twenty, before that a twentieth of the time so far."""
    now = [0.0]
    stream = io.StringIO()
    with PlainLines(straight(1e6), stream=stream, interval=5.0, clock=lambda: now[0]) as lines:
        for step in range(8640):
            now[0] = 10.0 * step
            lines.show(replace(MEASURES, step=step, time=now[0]))
    at = [10 * int(line.split("step ")[1].split()[0]) for line in stream.getvalue().splitlines()]
    gaps = np.diff(at[:-1])
    assert gaps[0] == 10 and gaps[-1] == 60
    assert np.all(gaps <= np.maximum(10, 0.05 * np.array(at[1:-1]) + 10))
    assert len(at) < 1600


def test_a_log_that_can_not_be_written_does_not_end_the_run() -> None:
    class Closed(io.StringIO):
        def write(self, _: str) -> int:
            raise BrokenPipeError

    with PlainLines(straight(1.0), stream=Closed()) as lines:
        lines.show(MEASURES)


def test_a_terminal_under_mpirun_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"):
        monkeypatch.delenv(name, raising=False)
    assert isinstance(progress_display(straight(1.0), Terminal()), Live)
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    assert isinstance(progress_display(straight(1.0), Terminal()), PlainLines)


def test_a_log_file_gets_no_control_characters() -> None:
    stream = io.StringIO()
    with progress_display(straight(1.0), stream) as display:
        display.show(MEASURES)
    assert "\x1b" not in stream.getvalue()
    assert stream.getvalue().count("\n") == 1


def test_time_to_go_is_measured_from_where_this_run_began() -> None:
    # A run resumed at 8 of 10 that did 1 in 30 s has 30 s to go, whatever happened before.
    assert remaining(0.0, 30.0, 0.8, 0.9) == pytest.approx(30.0)
    assert duration(remaining(0.0, 0.0, 0.8, 0.8)) == "?"
    assert duration(3725.4) == "1:02:05"
