"""Cuts with two ranks: they agree with one rank, also where the number of ranks changes on the way.

All fields agree to 1e-8 of their size. What differs is the order in which the matrix is factorised: some 1e-12 after
ten steps. A longer history drifts apart when a particle is inserted a step sooner or later.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from cut_worker import CUTS, State, advanced
from launch import mpirun

from pfemcut.pfem.method import PfemMethod

TOLERANCE = 1e-8


@cache
def one_rank(name: str) -> tuple[State, State]:
    """The states half way and at the end."""
    cut = CUTS[name]
    method = PfemMethod.start(cut.problem())
    return advanced(method, cut.half), advanced(method, cut.half)


def bare(state: State) -> State:
    """The state without the forces, which no state has."""
    return {name: values for name, values in state.items() if name != "tool_force"}


@pytest.fixture(scope="module")
def two_ranks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of what two ranks made of all cuts."""
    directory = tmp_path_factory.mktemp("two_ranks")
    for name in CUTS:
        np.savez(directory / f"{name}_start.npz", **bare(one_rank(name)[0]))
    done = mpirun(Path(__file__).with_name("cut_worker.py"), directory)
    assert done.returncode == 0, done.stderr
    return directory


def require_equal(found: State, wanted: State) -> None:
    """Equal triangles; fields to 1e-8 of their largest value, the ledger's amounts to 1e-8 of the tool's work."""
    assert np.array_equal(found["mesh/cells"], wanted["mesh/cells"])
    for name, values in wanted.items():
        size = float(np.abs(values.astype(float)).max(initial=0.0))
        if name == "ledger/area_drift":
            size = float(np.prod(np.ptp(wanted["mesh/points"].astype(float), axis=0)))
        elif name.startswith("ledger/"):
            # Some are round-off of sums that cancel.
            size = max(size, float(wanted["ledger/tool_work"]))
        difference = np.abs(found[name].astype(float) - values).max(initial=0.0)
        assert difference <= TOLERANCE * size, name


@pytest.mark.parametrize("name", CUTS)
def test_two_ranks_agree_with_one(two_ranks: Path, name: str) -> None:
    """A rigid tool; a deformable one with friction; a rigid one that conducts heat. Both ranks' bits are equal."""
    half, end = one_rank(name)
    assert end["ledger/inserted"] > 0
    require_equal(np.load(two_ranks / f"{name}_half.npz"), half)
    require_equal(np.load(two_ranks / f"{name}_end.npz"), end)


@pytest.mark.parametrize("name", CUTS)
def test_a_run_with_one_rank_goes_on_with_two(two_ranks: Path, name: str) -> None:
    require_equal(np.load(two_ranks / f"{name}_resumed.npz"), one_rank(name)[1])


@pytest.mark.parametrize("name", CUTS)
def test_a_run_with_two_ranks_goes_on_with_one(two_ranks: Path, name: str) -> None:
    half = bare(np.load(two_ranks / f"{name}_half.npz"))
    method = PfemMethod.restore(CUTS[name].problem(), half)
    require_equal(advanced(method, CUTS[name].half), one_rank(name)[1])
