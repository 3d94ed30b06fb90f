"""Convergence studies: order and index of known sequences, what refinement scales, and coarse cuts refined for real."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st
from problems import SHORT_CUT

from pfemcut.case.load import load_case
from pfemcut.cli.main import status
from pfemcut.converge.order import (
    Behaviour,
    convergence_of,
    grid_convergence_index,
    observed_order,
)
from pfemcut.converge.refinement import What, ladders_of, scaled_sizes, scaled_steps
from pfemcut.sweep import run as run_module
from pfemcut.validation.provenance import ROOT

NONE = (math.nan, math.nan, math.nan)


@given(
    order=st.floats(0.3, 2.0),
    ratio=st.floats(1.2, 3.0),
    limit=st.floats(1.0, 1000.0),
    error=st.floats(-0.2, 0.2).filter(lambda x: abs(x) > 1e-3),
)
def test_a_power_law_has_its_order_its_limit_and_its_error(
    order: float, ratio: float, limit: float, error: float
) -> None:
    """value = limit (1 + error h^p): Richardson finds the limit, and the index is 1.25 times the true error."""
    values = [limit * (1.0 + error * ratio ** (level * order)) for level in (2, 1, 0)]
    found = convergence_of(values, NONE, ratio)
    assert found.behaviour is Behaviour.MONOTONE
    assert found.order == pytest.approx(order, abs=1e-6)
    assert found.index == pytest.approx(1.25 * abs(limit - values[-1]) / abs(values[-1]), rel=1e-5)
    if order >= 0.51:
        assert found.extrapolated == pytest.approx(limit, rel=1e-6)


def test_the_example_of_celik_et_al() -> None:
    """Reattachment length of Celik et al. 2008, Table 1, first column: 6.063, 5.972, 5.863 with ratios 1.5 and 1.333.

    With non-constant ratios they find 1.53, 2.2 % and 6.1685; the formulas here take one ratio, so this uses the
    order of their table to check index and extrapolation, which only see the finest ratio.
    """
    fine, middle, ratio, order = 6.063, 5.972, 1.5, 1.53
    assert grid_convergence_index(fine, middle, ratio, order) == pytest.approx(0.022, abs=5e-4)
    assert fine + (fine - middle) / (ratio**order - 1.0) == pytest.approx(6.1685, abs=2e-3)


@pytest.mark.parametrize(
    ("values", "behaviour"),
    [
        ((1.0, 2.0, 1.6), Behaviour.OSCILLATING),
        ((1.0, 2.0, 0.5), Behaviour.SWINGING),
        ((1.0, 2.0, 1.0), Behaviour.SWINGING),
        ((1.0, 2.0, 4.0), Behaviour.DIVERGING),
        ((1.0, 2.0, 3.0), Behaviour.DIVERGING),
        ((1.0, 1.0, 2.0), Behaviour.DIVERGING),
        ((2.0, 2.0, 2.0), Behaviour.UNCHANGED),
        ((math.nan, 2.0, 2.5), Behaviour.UNKNOWN),
    ],
)
def test_what_does_not_converge_monotonically_has_no_order(
    values: tuple[float, ...], behaviour: Behaviour
) -> None:
    found = convergence_of(values, NONE, 2.0)
    assert found.behaviour is behaviour
    assert math.isnan(found.order) and math.isnan(found.index) and math.isnan(found.extrapolated)
    assert math.isnan(observed_order(*values, 2.0))


def test_half_of_the_range_is_left_of_an_oscillation() -> None:
    assert convergence_of((1.0, 2.0, 1.6), NONE, 2.0).half_range == pytest.approx(0.5 / 1.6, rel=1e-12)


def test_a_change_within_the_scatter_of_its_levels_gives_no_order() -> None:
    values = (104.0, 102.0, 101.0)
    assert convergence_of(values, (9.0, 0.5, 0.5), 2.0).order == pytest.approx(1.0)
    # 1 N/mm against a combined 1.0 by Pythagoras and a bit.
    assert convergence_of(values, (0.0, 0.61, 0.81), 2.0).behaviour is Behaviour.SCATTER
    # Where there is no scatter (the last value of a ledger), nothing is scatter.
    assert convergence_of(values, NONE, 2.0).behaviour is Behaviour.MONOTONE


def test_a_chance_order_makes_the_index_no_smaller_and_a_low_one_nothing_to_extrapolate() -> None:
    high = convergence_of((110.0, 101.0, 100.0), NONE, 2.0)
    assert high.order == pytest.approx(math.log2(9.0))
    assert high.index == pytest.approx(1.25 * 0.01 / 3.0)
    low = convergence_of((102.1, 101.0, 100.0), NONE, 2.0)
    assert 0.0 < low.order < 0.5
    assert math.isnan(low.extrapolated) and low.index > 0.05


def test_mesh_refinement_scales_every_size_of_every_mesh() -> None:
    case, _ = load_case(ROOT / "demos" / "42cd4" / "case.toml")
    sizes = scaled_sizes(case, 0.5)
    assert sizes == {
        "mesh.tip_size": 0.003,
        "mesh.shear_zone_size": 0.006,
        "mesh.chip_size": 0.01,
        "mesh.surface_size": 0.01,
        "mesh.far_size": 0.2,
        "mesh.growth": 0.03,
        "tool.body.tip_size": 0.0025,
        "tool.body.face_size": 0.008,
        "tool.body.growth": 0.06,
    }
    general, _ = load_case(ROOT / "tests" / "verification" / "prandtl_punch" / "case.toml")
    found = scaled_sizes(general, 2.0)
    assert found["mesh.size"] == pytest.approx(2.0 * general.mesh.size)  # type: ignore[union-attr]
    assert {"mesh.refine.0.size", "mesh.refine.0.growth"} <= set(found)


def test_step_refinement_scales_the_largest_step_and_what_lets_steps_grow() -> None:
    case, _ = load_case(ROOT / "demos" / "aisi4340_demo" / "case.toml")
    assert scaled_steps(case, 2.0) == {
        "time.step": 2.082e-7,
        "time.largest_step": 8.4e-7,
        "time.step_tolerance": 0.2,
    }
    plain, _ = load_case(ROOT / "demos" / "aisi4340_rake0" / "case.toml")
    assert set(scaled_steps(plain, 2.0)) == {"time.step"}


def test_levels_are_the_case_and_coarser_ones_unless_finer_are_asked_for() -> None:
    case, _ = load_case(ROOT / "demos" / "aisi4340_demo" / "case.toml")
    mesh, step = ladders_of(case, What.BOTH, 2.0, 3, 1)
    assert mesh.factors == step.factors == (2.0, 1.0, 0.5)
    assert [variant.name for variant in mesh.variants] == ["mesh=2", "case", "mesh=0.5"]
    assert [variant.name for variant in step.variants] == ["step=2", "case", "step=0.5"]
    (both,) = ladders_of(case, What.TOGETHER, 2.0, 3, 0)
    assert both.factors == (4.0, 2.0, 1.0)
    assert {"mesh.tip_size", "time.step"} <= set(both.variants[0].values)
    assert both.variants[-1].values == {}


def case_in(folder: Path, **changes: Any) -> Path:
    table: dict[str, Any] = {
        **SHORT_CUT,
        "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.004},
        "mesh": {
            "tip_size": 0.01,
            "shear_zone_size": 0.03,
            "chip_size": 0.03,
            "surface_size": 0.03,
            "far_size": 0.3,
            "growth": 0.3,
        },
        "time": {"step": 6e-8},
        "output": {"figures": False},
        **changes,
    }
    path = folder / "case.toml"
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def test_coarse_cuts_are_refined_and_a_second_call_only_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "out"
    command = [
        "converge",
        str(case_in(tmp_path)),
        "--what",
        "step",
        "--ratio",
        "2",
        "-o",
        str(output),
        "-j",
        "2",
    ]
    assert status(command) == 0
    out = capsys.readouterr().out
    assert "time steps relative to the case's" in out and "observed" in out
    content = json.loads((output / "convergence.json").read_text(encoding="utf-8"))
    steps = [content["runs"][name]["steps"] for name in ("step=4", "step=2", "case")]
    # A quarter of the first step ramps up, so not quite a half each.
    assert steps[0] < steps[1] < steps[2]
    with (output / "convergence.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["figure"]: row for row in csv.DictReader(file)}
    force = next(each for each in content["findings"] if each["figure"] == "cutting_force")
    assert [float(rows["cutting_force"][f"level_{i}"]) for i in (1, 2, 3)] == force["values"]
    again = convergence_of(force["values"], force["deviations"], 2.0)
    assert force["behaviour"] == again.behaviour.value
    for name in ("convergence.png", "results.csv", "results.json"):
        assert (output / name).stat().st_size > 0

    def not_to_be_called(*_: object) -> None:
        raise AssertionError("nothing may run")

    monkeypatch.setattr(run_module, "_task", not_to_be_called)
    assert status(command) == 0
    assert "3 finished" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--ratio", "1"], "--ratio: given 1, must be greater than 1"),
        (["--levels", "2"], "--levels: given 2, must be at least 3"),
        (["--finer", "3"], "--finer: given 3, must be from 0 to 2"),
        (["--figures", "cuting_force"], "did you mean 'cutting_force'?"),
        (["--what", "meshes"], "meshes"),
        (["--set", "cutting.depht=1"], "variant case: [cutting] depht: unknown key; did you mean 'depth'?"),
        (["--ratio", "4"], "variant mesh=16: [mesh] growth"),
        (["--list", "--collect"], "exclude each other"),
    ],
)
def test_bad_input_is_named_before_anything_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], words: str
) -> None:
    output = tmp_path / "out"
    assert status(["converge", str(case_in(tmp_path)), "-o", str(output), *options]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert not output.exists()


def test_the_list_names_the_levels(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["converge", str(case_in(tmp_path)), "--what", "both", "--list"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if not line.startswith("warning")]
    assert [line.split()[1] for line in lines] == ["mesh=2", "mesh=1.414", "case", "step=2", "step=1.414"]
