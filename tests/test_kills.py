"""Runs that are killed, or find the disk full or read-only, at any call to the operating system lose nothing.

The whole list of calls takes minutes: ``python tests/kill_worker.py FOLDER kill 1 1``; here every 151st is tried.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from problems import SHORT_CUT

import pfemcut

ROOT = Path(__file__).parents[1]
ENVIRONMENT = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'tests'}", "OMP_NUM_THREADS": "1"}


@pytest.mark.parametrize(("event", "first"), [("kill", 11), ("full", 37), ("readonly", 83)])
def test_a_fault_at_any_call_keeps_the_last_checkpoint_and_resumes_to_the_same_bytes(
    tmp_path: Path, event: str, first: int
) -> None:
    command = [sys.executable, ROOT / "tests/kill_worker.py", tmp_path, event, str(first), "151"]
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    *wrong, tried = done.stdout.splitlines()
    assert not wrong, "\n".join(wrong)
    assert int(tried) >= 7


@pytest.mark.slow
def test_a_cut_killed_at_random_moments_gives_the_same_history(tmp_path: Path) -> None:
    changes = {
        "cutting.travel": 0.012,
        "mesh.growth": 0.3,
        "output.figures": False,
        "output.checkpoint_every": 1,
    }
    case = tmp_path / "case.toml"
    case.write_text(pfemcut.load_case(SHORT_CUT, changes).toml())
    command = [sys.executable, "-m", "pfemcut", "run", case, "-o"]
    begun = time.monotonic()
    subprocess.run([*command, tmp_path / "whole"], env=ENVIRONMENT, check=True, capture_output=True)
    lasts, rng, kills = time.monotonic() - begun, random.Random(5), 0
    killed = tmp_path / "killed"
    while True:
        again = ["--resume"] if any(killed.glob("checkpoint*.h5")) else ["--overwrite"]
        process = subprocess.Popen([*command, killed, *again], env=ENVIRONMENT, stdout=subprocess.DEVNULL)
        try:
            assert process.wait(timeout=lasts * rng.uniform(0.3, 1.0) if kills < 8 else None) == 0
            break
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
    assert kills > 0
    assert (killed / "history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()
