"""The progress display: plain lines when not a terminal, not too many, and a fair time to go."""

from __future__ import annotations

import io
from dataclasses import replace

import pytest
from test_history import MEASURES

from pfemcut.output.progress import PlainLines, duration, progress_display, remaining


def test_plain_lines_come_every_few_seconds_and_at_the_end() -> None:
    # The run was resumed at 50 of 150: what came before is no measure of the pace.
    now = [0.0]
    stream = io.StringIO()
    with PlainLines(end=150.0, stream=stream, interval=5.0, clock=lambda: now[0]) as lines:
        for second in range(12):
            now[0] = float(second)
            lines.show(replace(MEASURES, step=second, time=50.0 + second))
    text = stream.getvalue().splitlines()
    assert [line.split("step ")[1].split()[0] for line in text] == ["0", "5", "10", "11"]
    assert text[-1].endswith("to go 0:01:29")
    for needed in ("travel 0.0003 mm", "Fc 120.0", "Ft 40.0", "Tmax 293 K"):
        assert needed in text[-1]


def test_a_log_file_gets_no_control_characters() -> None:
    stream = io.StringIO()
    with progress_display(1.0, stream) as display:
        display.show(MEASURES)
    assert "\x1b" not in stream.getvalue()
    assert stream.getvalue().count("\n") == 1


def test_time_to_go_is_measured_from_where_this_run_began() -> None:
    # A run resumed at 8 of 10 that did 1 in 30 s has 30 s to go, whatever happened before.
    assert remaining(0.0, 30.0, 8.0, 9.0, 10.0) == pytest.approx(30.0)
    assert duration(remaining(0.0, 0.0, 8.0, 8.0, 10.0)) == "?"
    assert duration(3725.4) == "1:02:05"
