"""Runs under mpirun: errors on one rank or all end all of them, at once and told once; signals leave a checkpoint."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from launch import OPEN_MPI, TESTS, mpirun
from rank_worker import STEP
from test_driver import run

from pfemcut import launcher
from pfemcut.inputs import UserError
from pfemcut.ranks import Ranks
from pfemcut.results.checkpoint import read_checkpoint

CASE = """
[workpiece]
length = 1.2
height = 0.6
material = "aisi4340"
[tool]
tip_radius = 0.025
[cutting]
speed = 3330.0
depth = 0.1
travel = 0.003
[mesh]
tip_size = 0.008
shear_zone_size = 0.02
chip_size = 0.03
surface_size = 0.03
far_size = 0.6
growth = 0.15
[time]
step = 2e-7
[output]
figures = false
"""


def happened(event: str, directory: Path, patience: int = 1) -> subprocess.CompletedProcess[str]:
    return mpirun(TESTS / "rank_worker.py", event, directory, patience=patience)


def own_words(done: subprocess.CompletedProcess[str], program: str = "rank_worker.py") -> list[str]:
    """The lines on standard error that are not mpirun's."""
    return [line for line in done.stderr.splitlines() if line.startswith(f"{program}: ")]


@pytest.mark.parametrize(
    ("event", "rank"), [("error on rank 1", 1), ("error on all ranks", 0), ("no start on rank 1", 1)]
)
def test_an_unforeseen_error_ends_all_ranks_and_is_told_once(tmp_path: Path, event: str, rank: int) -> None:
    done = happened(event, tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("Traceback") == 1
    assert f"error on rank {rank}:" in done.stderr
    assert "on purpose" in done.stderr
    if "start" not in event:
        assert read_checkpoint(tmp_path).step == 5


def test_a_run_that_cannot_go_on_ends_on_all_ranks_as_on_one(tmp_path: Path) -> None:
    done = happened("stop", tmp_path)
    assert (done.returncode, own_words(done)) == (
        1,
        ["rank_worker.py: run stopped: no convergence, on purpose"],
    )
    assert read_checkpoint(tmp_path).step == STEP - 1
    assert json.loads((tmp_path / "summary.json").read_text())["finished"] is False


@pytest.mark.parametrize("event", ["other bits on rank 1", "stop on rank 1"])
def test_ranks_that_differ_stop_and_leave_the_last_good_checkpoint(tmp_path: Path, event: str) -> None:
    done = happened(event, tmp_path)
    assert done.returncode == 1
    assert len(own_words(done)) == 1
    assert "the ranks came to different results" in own_words(done)[0]
    assert read_checkpoint(tmp_path).step == 5
    assert not (tmp_path / "summary.json").exists()


def test_a_full_disk_is_one_clear_error(tmp_path: Path) -> None:
    done = happened("full disk", tmp_path)
    assert done.returncode == 2
    assert len(own_words(done)) == 1
    assert "can't be written: File too large" in own_words(done)[0]
    assert read_checkpoint(tmp_path).step == 5


@pytest.mark.parametrize("event", ["SIGUSR1", "SIGTERM", "SIGINT"])
def test_a_signal_to_mpirun_leaves_a_checkpoint_to_resume_from(tmp_path: Path, event: str) -> None:
    """One rank goes on bit for bit.

    mpirun hands the signal on, but Open MPI's makes SIGTERM of those that end it.
    """
    # Checkpoint and summary take milliseconds; a second is too short on a busy machine only.
    done = happened(event, tmp_path / "stopped", patience=3)
    assert done.returncode == 1
    assert read_checkpoint(tmp_path / "stopped").step == STEP
    summary = json.loads((tmp_path / "stopped" / "summary.json").read_text())
    handed_on = "SIGTERM" if OPEN_MPI and event == "SIGINT" else event
    assert f"stopped by {handed_on}" in summary["ending"]
    run(tmp_path / "stopped", resume=True)
    run(tmp_path / "whole")
    whole, resumed = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "stopped"))
    assert resumed == whole


def test_a_cut_from_the_command_line(tmp_path: Path) -> None:
    """Rank 0 alone prints, in plain lines: mpirun gives it a pseudo-terminal, which a progress bar would flood."""
    (tmp_path / "case.toml").write_text(CASE)
    done = mpirun("-m", "pfemcut", "run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert "\x1b" not in done.stdout
    assert sum("reached its final time" in line for line in lines) == 1
    steps = json.loads((tmp_path / "out" / "summary.json").read_text())["steps"]["value"]
    shown = [line.split("step ")[1].split()[0] for line in lines if line.startswith("travel ")]
    assert shown[0] == "1"
    assert shown[-1] == str(steps)
    assert len(set(shown)) == len(shown)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--set", "tool.rake=steep"], "[tool] rake"),
        (["-o", "/proc/self"], "/proc/self"),
    ],
    ids=["bad input", "unwritable"],
)
def test_bad_input_is_one_clear_error(tmp_path: Path, options: list[str], complaint: str) -> None:
    (tmp_path / "case.toml").write_text(CASE)
    done = mpirun("-m", "pfemcut", "run", tmp_path / "case.toml", *options)
    assert done.returncode == 2
    assert len(own_words(done, "pfemcut")) == 1
    assert complaint in own_words(done, "pfemcut")[0]


def test_mpirun_of_another_mpi_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every process would be a run of its own, all in one directory."""
    monkeypatch.setenv("PMI_RANK", "0")
    monkeypatch.setenv("PMI_SIZE", "4")
    assert launcher.launched()
    with pytest.raises(UserError, match="one of 4 processes.*different MPI libraries"):
        Ranks()


def test_only_the_first_process_speaks(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"):
        monkeypatch.delenv(name, raising=False)
    # Tasks of srun without MPI are runs of their own.
    monkeypatch.setenv("SLURM_PROCID", "3")
    assert launcher.speaks()
    assert not launcher.launched()
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    assert not launcher.speaks()
