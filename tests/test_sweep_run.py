"""The pool of processes of a sweep, and short cuts run side by side."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from sweeps import written_case, written_study

from pfemcut.cli.main import status
from pfemcut.output.directory import OutputError
from pfemcut.sweep import run as run_module
from pfemcut.sweep.pool import Command, Ended, Watcher, run_pool
from pfemcut.sweep.prepare import State, prepared, states
from pfemcut.sweep.study_file import read_plan
from pfemcut.sweep.worker import _claim

FRICTIONS = ("friction=0", "friction=0.2")
STUDY = """\
case = "case.toml"
[grid]
contact.friction = [0.0, 0.2]
[[variant]]
name = "fails"
time.smallest_step_fraction = 1.0
solver.max_iterations = 2
"""


# The pool


def python(tmp_path: Path, name: str, code: str) -> Command:
    return Command(name, (sys.executable, "-c", code), b"given", tmp_path / name / "log")


class Notes(Watcher):
    """Remembers what the pool told; ``event`` is called when time passes."""

    def __init__(self, event: Callable[[Sequence[str]], None] = lambda running: None) -> None:
        self.event = event
        self.most = 0
        self.order: list[str] = []
        self.stops = 0

    def started(self, name: str) -> None:
        self.order.append(name)

    def stopping(self) -> None:
        self.stops += 1

    def passing(self, running: Sequence[str]) -> None:
        self.most = max(self.most, len(running))
        self.event(running)


def test_the_pool_runs_all_a_few_at_a_time_and_a_failure_stops_no_other(tmp_path: Path) -> None:
    code = "import os, sys, time; print(sys.stdin.read(5), os.environ['OMP_NUM_THREADS']); time.sleep(0.3); "
    commands = [python(tmp_path, f"p{i}", code + f"sys.exit({i % 2})") for i in range(4)]
    commands.append(python(tmp_path, "dead", "import os; os.kill(os.getpid(), 9)"))
    notes = Notes()
    ended = run_pool(commands, 2, notes)
    assert ended == Ended({"p0": 0, "p1": 1, "p2": 0, "p3": 1, "dead": -9}, 0)
    assert notes.order == ["p0", "p1", "p2", "p3", "dead"]
    assert notes.most == 2
    assert (tmp_path / "p3" / "log").read_text() == "given 1\n"


PATIENT = """
import pathlib, signal, sys, time
times = []
def note(number, frame): times.append(number)
for number in (signal.SIGINT, signal.SIGTERM): signal.signal(number, note)
pathlib.Path({ready!r}).touch()
while not times or {deaf}: time.sleep(0.01)
time.sleep(0.3)
print(len(times))
sys.exit(1)
"""


def patient(tmp_path: Path, name: str, *, deaf: bool = False) -> Command:
    """A process that ends, with status 1, some time after a signal; or never."""
    (tmp_path / name).mkdir()
    return python(tmp_path, name, PATIENT.format(ready=str(tmp_path / name / "ready"), deaf=deaf))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_handed_on_once_and_waits_for_the_end(tmp_path: Path, number: signal.Signals) -> None:
    sent: list[int] = []

    def event(running: Sequence[str]) -> None:
        if not sent and all((tmp_path / name / "ready").exists() for name in ("a", "b")):
            sent.append(number)
            signal.raise_signal(number)

    commands = [patient(tmp_path, name) for name in ("a", "b", "c")]
    notes = Notes(event)
    assert run_pool(commands, 2, notes) == Ended({"a": 1, "b": 1}, number)
    assert notes.stops == 1
    assert [(tmp_path / name / "log").read_text() for name in ("a", "b")] == ["1\n", "1\n"]


def test_a_second_signal_kills(tmp_path: Path) -> None:
    def event(_: Sequence[str]) -> None:
        if (tmp_path / "a" / "ready").exists():
            signal.raise_signal(signal.SIGINT)

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_pool([patient(tmp_path, "a", deaf=True)], 1, Notes(event))
    assert time.monotonic() - begun < 20.0


def test_a_worker_stops_when_the_sweep_is_gone() -> None:
    code = (
        "from pfemcut.sweep.worker import _stop_when_alone; import time; _stop_when_alone(); time.sleep(60)"
    )
    done = subprocess.run([sys.executable, "-c", code], stdin=subprocess.DEVNULL, timeout=50, check=False)
    assert done.returncode == -signal.SIGTERM


def test_a_variant_that_runs_already_is_left_to_its_process(tmp_path: Path) -> None:
    held = _claim(tmp_path)
    with pytest.raises(OutputError, match="another process is running this variant"):
        _claim(tmp_path)
    os.close(held)
    os.close(_claim(tmp_path))


# Short cuts side by side


def rows_in(folder: Path) -> dict[str, dict[str, str]]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        return {row["variant"]: row for row in csv.DictReader(file)}


def json_in(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a study of two cuts, run two at a time, and a variant that can't converge."""
    folder = tmp_path_factory.mktemp("study")
    written_case(folder)
    study = written_study(folder, STUDY)
    assert status(["sweep", str(study), "-o", str(folder / "two"), "-j", "2"]) == 1
    return folder


def test_a_variant_that_fails_stops_no_other_and_stands_in_the_table(finished: Path) -> None:
    rows = rows_in(finished / "two")
    assert {name: row["status"] for name, row in rows.items()} == {
        **dict.fromkeys(FRICTIONS, "finished"),
        "fails": "stopped",
    }
    assert "no convergence" in rows["fails"]["warnings"]
    assert "no convergence" in (finished / "two" / "fails" / "run.log").read_text()
    assert (finished / "two" / "results.png").stat().st_size > 10_000


def test_the_table_has_the_figures_of_the_summaries(finished: Path) -> None:
    content = json_in(finished / "two" / "results.json")
    assert content["parameters"] == [
        "contact.friction",
        "time.smallest_step_fraction",
        "solver.max_iterations",
    ]
    assert {"command", "date", "version", "commit"} <= set(content["recorded"])
    for name, row in rows_in(finished / "two").items():
        summary = json_in(finished / "two" / name / "summary.json")
        (entry,) = (entry for entry in content["variants"] if entry["name"] == name)
        figures = {
            key: value for key, value in summary.items() if isinstance(value, dict) and "unit" in value
        }
        for figure in ("steady", "steps", "wall_time"):
            del figures[figure]
        assert figures
        assert entry["figures"] == figures
        for figure, value in figures.items():
            assert float(row[figure]) == value.get("mean", value.get("value"))
            assert row.get(f"{figure}_std", "") == (str(value["std"]) if "std" in value else "")
        assert float(row["wall_time"]) == summary["wall_time"]["value"]
        assert row["warnings"] == "; ".join(summary["warnings"])
    inputs = tomllib.loads((finished / "two" / "friction=0.2" / "inputs.resolved.toml").read_text())
    assert inputs["contact"]["friction"] == 0.2


def test_a_second_call_runs_nothing_and_a_changed_case_is_an_error(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(finished / "two", tmp_path / "two")
    started: list[str] = []

    def pool(commands: Sequence[Command], jobs: int, watcher: Watcher) -> Ended:
        started.extend(command.name for command in commands)
        return Ended({}, 0)

    monkeypatch.setattr(run_module, "run_pool", pool)
    same = ["sweep", str(finished / "case.toml"), "-o", str(tmp_path / "two")]
    assert status([*same, "--vary", "contact.friction=0.0,0.2"]) == 0
    assert started == []
    said = capsys.readouterr().out
    assert "2 variants" in said
    assert ": 2 finished" in said
    assert "not of this sweep, left alone: fails" in said

    changed = [*same, "--vary", "contact.friction=0.0,0.2", "--set", "cutting.depth=0.11"]
    assert status(changed) == 2
    assert (
        f"{tmp_path}/two/friction=0, {tmp_path}/two/friction=0.2: "
        "the run of another case is there (cutting.depth: 0.1 -> 0.11)" in capsys.readouterr().err
    )
    shorter = [*same, "--vary", "contact.friction=0.0,0.2", "--set", "cutting.travel=0.004"]
    assert status(shorter) == 2
    assert "cutting.travel: 0.008 -> 0.004" in capsys.readouterr().err
    assert started == []
    assert status([*changed, "--collect"]) == 1
    assert {row["status"] for row in rows_in(tmp_path / "two").values()} == {"of another case"}
    assert status([*changed, "--overwrite"]) == 1
    longer = [*same, "--vary", "contact.friction=0.0,0.2,0.4", "--set", "cutting.travel=0.01"]
    assert status(longer) == 1
    assert started == [*FRICTIONS, *FRICTIONS, "friction=0.4"]
    assert ": 1 new, 2 goes on" in capsys.readouterr().out


def test_an_interrupted_sweep_goes_on_and_gives_what_runs_side_by_side_give(
    finished: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One at a time, interrupted, gone on with by name and by number: bit for bit the same, as each has one thread."""
    one = finished / "one"
    command = ["sweep", str(finished / "case.toml"), "--vary", "contact.friction=0.0,0.2", "-o", str(one)]
    history = one / "friction=0" / "history.csv"

    def interrupt() -> None:
        while not history.is_file() or history.read_bytes().count(b"\n") < 4:
            time.sleep(0.02)
        signal.raise_signal(signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    assert status([*command, "-j", "1"]) == 1
    told = capsys.readouterr().err
    assert "stopped by SIGINT, 0 of 2 variants finished" in told
    # Each folder that is left, for whoever wants to look.
    assert all(f"/friction={value}" in told for value in ("0", "0.2"))
    assert not (one / "friction=0.2").exists()
    plan = read_plan(finished / "case.toml", vary=["contact.friction=0.0,0.2"], output=one)
    assert states(prepared(plan)) == (State.INTERRUPTED, State.NEW)

    assert status([*command, "--only", "friction=0"]) == 0
    assert [session["resumed"] for session in json_in(history.parent / "sessions.json")] == [False, True]
    assert not (one / "results.csv").exists()
    assert status([*command, "--collect"]) == 1
    assert {name: row["status"] for name, row in rows_in(one).items()} == {
        "friction=0": "finished",
        "friction=0.2": "not finished",
    }
    assert status([*command, "--index", "1"]) == 0
    assert status([*command, "--collect"]) == 0
    for name in FRICTIONS:
        assert (one / name / "history.csv").read_bytes() == (
            finished / "two" / name / "history.csv"
        ).read_bytes()
    assert status([*command, "--index", "1"]) == 0
    assert "friction=0.2: finished before" in capsys.readouterr().out
