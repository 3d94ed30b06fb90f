"""The driver, with a method of three numbers: resume, signals, stops and what stays on disk."""

from __future__ import annotations

import csv
import json
import os
import resource
import signal
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from synthetic_cut import CUT, outline_frame, tool_of

from pfemcut.driver import MethodFactory, RunInterrupted, run_problem
from pfemcut.method import CutEnded, Frame, Measures, RunStopped
from pfemcut.output.directory import OutputError
from pfemcut.output.vtu import read_collection
from pfemcut.problem import MovingTool
from pfemcut.results.checkpoint import CheckpointError, read_checkpoint
from pfemcut.results.derived.columns import derived_columns
from pfemcut.results.history import read_table
from pfemcut.results.summary import Summary

INPUTS = """[cutting]
speed = 3.0
depth = 0.1
travel = 1.0
[tool]
rake = 6.0
clearance = 5.0
tip_radius = 0.025
"""
FRAME = replace(outline_frame(6.0, 0.15), time=0.0, travel=0.0)


@dataclass(frozen=True)
class Controls:
    every: int = 4
    history_every: int = 1
    checkpoint_every: int = 5
    figures: bool = False


class ChaoticMethod:
    """A logistic map: the smallest difference in restored state shows within a few steps.

    ``events`` are called at the begin of the step of their key.
    """

    def __init__(
        self, last: int, step: int = 0, x: float = 0.3, events: Mapping[int, Callable[[], None]] | None = None
    ) -> None:
        self.last, self.step, self.x, self.events = last, step, x, events or {}

    @property
    def finished(self) -> bool:
        return self.step >= self.last

    def advance(self) -> None:
        self.events.get(self.step + 1, lambda: None)()
        self.step += 1
        self.x = 3.9 * self.x * (1.0 - self.x)

    def measure(self) -> Measures:
        t = 0.05 * self.step
        return Measures(
            self.step, t, 0.05, t, 100 * self.x, 30.0, 0.1, 300.0, 1.0, t, t, 0.0, 0.0, 0.0, 0.0, 9
        )

    def own_measures(self) -> Mapping[str, float]:
        return {"heat_error": 0.0, "outside": 0}

    def timing(self) -> Mapping[str, float]:
        return {"momentum": 0.001}

    def frame(self) -> Frame:
        velocity = np.full_like(FRAME.points, 1000.0 * self.x)
        fields = {**FRAME.point_fields, "velocity": velocity}
        return replace(FRAME, step=self.step, time=0.05 * self.step, point_fields=fields)

    def state(self) -> Mapping[str, np.ndarray]:
        return {"step": np.array(self.step), "x": np.array(self.x)}


def run(
    directory: Path, last: int = 20, events: Mapping[int, Callable[[], None]] | None = None, **options: object
) -> Summary:
    problem = SimpleNamespace(
        title="a",
        time=SimpleNamespace(end=0.05 * last),
        cut=(CUT,),
        tool=(MovingTool(tool_of(6.0), (-CUT.speed, 0.0)),),
        pairs=(),
        others=(),
        after=(),
        ends_stage=lambda time: False,
        cutting_at=lambda time: True,
    )
    factory = MethodFactory(
        start=lambda: ChaoticMethod(last, events=events),
        restore=lambda state: ChaoticMethod(last, int(state["step"]), float(state["x"]), events),
    )
    controls = options.pop("controls", Controls())
    arguments = {"inputs": INPUTS, **options}
    return run_problem(problem, factory, directory, controls, **arguments)  # type: ignore[arg-type]


def raising(error: Exception) -> Callable[[], None]:
    def event() -> None:
        raise error

    return event


def summary_in(directory: Path) -> dict:
    return json.loads((directory / "summary.json").read_text())


def frames_in(directory: Path) -> list[int]:
    return sorted({entry.step for entry in read_collection(directory)})


def test_a_finished_run_leaves_everything(tmp_path: Path) -> None:
    summary = run(tmp_path, last=10)
    assert (summary.finished, summary.steps) == (True, 10)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "history.csv",
        "timing.csv",
        "contact.csv",
        "tool_profiles.csv",
        "summary.json",
        "inputs.resolved.toml",
        "fields.pvd",
        "fields",
        "checkpoint.h5",
        "checkpoint.previous.h5",
    }
    assert frames_in(tmp_path) == [0, 4, 8, 10]
    assert read_table(tmp_path / "history.csv")["step"].tolist() == list(range(1, 11))
    with (tmp_path / "timing.csv").open() as file:
        assert next(csv.reader(file)) == ["step", "momentum", "output", "total"]
    assert (tmp_path / "inputs.resolved.toml").read_text() == INPUTS


def test_derived_columns_follow_the_methods_own(tmp_path: Path) -> None:
    run(tmp_path, last=2)
    header = (tmp_path / "history.csv").read_text().splitlines()[0].split(",")
    assert header[16:] == ["heat_error", "outside", *derived_columns(FRAME, CUT)]
    assert summary_in(tmp_path)["chip_thickness"]["mean"] == pytest.approx(0.15)


def test_history_rows_are_as_wished_and_the_last_one_is_never_missing(tmp_path: Path) -> None:
    run(tmp_path, last=10, controls=Controls(history_every=4))
    assert read_table(tmp_path / "history.csv")["step"].tolist() == [4, 8, 10]


@pytest.mark.parametrize("killed_at", [1, 7, 10, 13])
def test_resume_equals_uninterrupted_byte_for_byte(tmp_path: Path, killed_at: int) -> None:
    # Killed without warning: the error is none that the driver knows, so no checkpoint is written at the end.
    run(tmp_path / "whole")
    with pytest.raises(MemoryError):
        run(
            tmp_path / "killed",
            events={killed_at: raising(MemoryError())},
            controls=Controls(checkpoint_every=1),
        )
    run(tmp_path / "killed", resume=killed_at > 1, overwrite=killed_at == 1)
    whole, resumed = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "killed"))
    assert resumed == whole
    assert frames_in(tmp_path / "killed") == frames_in(tmp_path / "whole")
    for name in ("contact.csv", "tool_profiles.csv"):
        assert (tmp_path / "killed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert np.unique(read_table(tmp_path / "whole/contact.csv")["step"]).tolist() == [10, 20]


def test_resume_repeats_the_steps_after_the_checkpoint(tmp_path: Path) -> None:
    run(tmp_path / "whole")
    with pytest.raises(MemoryError):
        # The checkpoint is that of step 9, before the contact record of step 10.
        run(tmp_path / "killed", events={14: raising(MemoryError())}, controls=Controls(checkpoint_every=9))
    assert read_table(tmp_path / "killed/history.csv")["step"][-1] == 13
    run(tmp_path / "killed", resume=True)
    for table in ("history.csv", "contact.csv"):
        whole, resumed = ((tmp_path / name / table).read_bytes() for name in ("whole", "killed"))
        assert resumed == whole
    assert read_table(tmp_path / "killed/timing.csv")["step"].tolist() == list(range(1, 21))


def test_a_finished_run_can_be_taken_further(tmp_path: Path) -> None:
    run(tmp_path / "whole")
    run(tmp_path / "longer", last=12)
    run(tmp_path / "longer", resume=True, inputs=INPUTS.replace("travel = 1.0", "travel = 2.0"))
    whole, longer = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "longer"))
    assert longer == whole


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1])
def test_a_signal_finishes_the_step_and_leaves_a_checkpoint(tmp_path: Path, number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with pytest.raises(RunInterrupted, match=f"{number.name} after step 7.*resumed"):
        run(tmp_path / "stopped", events={7: lambda: os.kill(os.getpid(), number)})
    assert signal.getsignal(number) is before
    assert read_checkpoint(tmp_path / "stopped").step == 7
    assert summary_in(tmp_path / "stopped")["finished"] is False
    run(tmp_path / "stopped", resume=True)
    run(tmp_path / "whole")
    whole, resumed = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "stopped"))
    assert resumed == whole


def test_a_second_signal_kills(tmp_path: Path) -> None:
    def twice() -> None:
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, events={3: twice})


def test_a_run_that_cannot_go_on_keeps_outputs_and_checkpoint_and_says_why(tmp_path: Path) -> None:
    with pytest.raises(RunStopped, match="the tip at 0.1"):
        run(tmp_path, events={8: raising(RunStopped("no convergence near the tip at 0.1 mm"))})
    assert read_checkpoint(tmp_path).step == 7
    assert frames_in(tmp_path) == [0, 4, 7]
    found = summary_in(tmp_path)
    assert found["finished"] is False
    assert "no convergence near the tip at 0.1 mm" in found["warnings"]
    assert found["steps"]["value"] == 7


def test_a_run_that_stops_at_once_has_a_summary_too(tmp_path: Path) -> None:
    with pytest.raises(RunStopped):
        run(tmp_path, events={1: raising(RunStopped("at once"))})
    assert summary_in(tmp_path)["ending"] == "at once"


def test_a_cut_that_ends_early_is_finished_and_says_so(tmp_path: Path) -> None:
    summary = run(tmp_path, events={8: raising(CutEnded("the chip touched the workpiece"))})
    assert summary.finished
    assert "the chip touched the workpiece" in summary.warnings


def test_results_are_never_destroyed_unasked(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text("mine")
    run(tmp_path, last=3)
    history = (tmp_path / "history.csv").read_bytes()
    with pytest.raises(OutputError, match="another run.*resume"):
        run(tmp_path, last=4)
    assert (tmp_path / "history.csv").read_bytes() == history
    run(tmp_path, last=4, overwrite=True)
    assert read_table(tmp_path / "history.csv")["step"].tolist() == [1, 2, 3, 4]
    assert (tmp_path / "case.toml").read_text() == "mine"


def test_resuming_another_case_or_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="no run to resume"):
        run(tmp_path / "nothing", resume=True)
    run(tmp_path / "a", last=3)
    with pytest.raises(CheckpointError, match="cutting.speed: 3.0 -> 4.0"):
        run(tmp_path / "a", resume=True, inputs=INPUTS.replace("3.0", "4.0"))
    (tmp_path / "empty").mkdir()
    with pytest.raises(CheckpointError, match="no checkpoint"):
        run(tmp_path / "empty", resume=True)


def test_a_resume_that_is_refused_leaves_what_was_concluded(tmp_path: Path) -> None:
    cut = "[cutting]\nspeed = 3.0\ntravel = 0.3\n"
    run(tmp_path, last=4, inputs=cut)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(CheckpointError, match=r"has cut 0.6 mm, more than travel = 0.3"):
        run(tmp_path, resume=True, inputs=cut + "[after]\ncool = true\n")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_a_damaged_checkpoint_costs_some_steps_and_a_warning(tmp_path: Path) -> None:
    run(tmp_path / "whole")
    run(tmp_path / "hurt", last=12)
    path = tmp_path / "hurt/checkpoint.h5"
    path.write_bytes(path.read_bytes()[:700])
    summary = run(tmp_path / "hurt", resume=True)
    assert "previous" in summary.warnings[0]
    assert (tmp_path / "hurt/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()


def test_a_place_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="is a file"):
        run(tmp_path / "file")
    with pytest.raises(OutputError, match="can't be written: Not a directory"):
        run(tmp_path / "file/below")
    # Not even root may write there.
    with pytest.raises(OutputError, match="can't be written"):
        run(Path("/proc/self"))


@pytest.mark.parametrize(("step", "size"), [(8, 2000), (10, 6000)], ids=["in the history", "in a checkpoint"])
def test_a_full_disk_is_one_clear_error_and_the_last_checkpoint_stays(
    tmp_path: Path, step: int, size: int
) -> None:
    def fill() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        with pytest.raises(OutputError, match="can't be written: File too large"):
            run(tmp_path, events={step: fill})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert read_checkpoint(tmp_path).step == 5
