"""Predictions of measured cuts: their cases are those measured, and the comparison's arithmetic."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from pfemcut.case.check import warnings
from pfemcut.case.load import load_case
from pfemcut.case.schema import Case
from pfemcut.inputs import InputError
from pfemcut.results.derived.force_shares import force_shares
from pfemcut.validation.prediction import (
    Figure,
    convergence_index,
    differences,
    half_width,
    load_measurements,
    mean_and_largest,
)
from pfemcut.validation.study import Variant
from tests.synthetic_cut import outline_frame

DEMOS = Path(__file__).parent.parent / "demos"
SETS = {
    "ti6al4v_ducobu": {
        (depth, speed) for depth in (0.04, 0.06, 0.08) for speed in (5.0, 7.5, 10.0, 20.0, 30.0, 40.0)
    },
    "aisi1045_klocke": {(0.1, 100.0), (0.2, 100.0), (0.3, 100.0), (0.1, 50.0)},
}


def script(name: str) -> ModuleType:
    path = DEMOS / name / "predict.py"
    spec = importlib.util.spec_from_file_location(f"predict_{name}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def planned_changes(variant: Variant) -> tuple[str, ...]:
    return (f"cutting.travel={variant.travel}", *variant.changes)


def cutting_case(folder: Path, overrides: tuple[str, ...] = ()) -> Case:
    case, material = load_case(folder / "case.toml", overrides)
    assert isinstance(case, Case)
    # That so short a cut does not heat the tool through is said in the README.
    assert [line for line in warnings(case, material) if "beginning cut" not in line] == []
    return case


@pytest.mark.parametrize("name", SETS)
def test_the_cuts_are_those_that_were_measured(name: str) -> None:
    module = script(name)
    planned = {cut.name: cut for cut in module.PREDICTED.cuts}
    assert {(cut.depth, cut.speed) for cut in planned.values()} == SETS[name]
    assert set(load_measurements(DEMOS / name / "measured.toml")) <= set(planned)
    runs = {variant.name: variant for variant in module.STUDY.variants}
    assert len(runs) == len(module.STUDY.variants)
    for cut in planned.values():
        case = cutting_case(DEMOS / name, planned_changes(runs[cut.name]))
        assert case.cutting.depth == cut.depth
        assert case.cutting.speed == pytest.approx(cut.speed * 1000.0 / 60.0, rel=1e-5)
        assert case.contact.reference_speed == pytest.approx(0.01 * case.cutting.speed, rel=1e-4)
    for other in set(runs) - set(planned):
        load_case(DEMOS / name / "case.toml", planned_changes(runs[other]))


@pytest.mark.parametrize("name", SETS)
def test_the_case_file_is_the_base_cut(name: str) -> None:
    module = script(name)
    alone = cutting_case(DEMOS / name)
    base = next(variant for variant in module.STUDY.variants if variant.name == module.PREDICTED.base.name)
    varied = cutting_case(DEMOS / name, planned_changes(base))
    for section in ("workpiece", "tool", "cutting", "contact", "mesh", "time"):
        given, changed = getattr(alone, section).model_dump(), getattr(varied, section).model_dump()
        for key, value in changed.items():
            if isinstance(value, float):
                assert given[key] == pytest.approx(value, rel=1e-3), f"[{section}] {key}"
            else:
                assert given[key] == value, f"[{section}] {key}"


def test_friction_of_titanium_is_that_of_the_cutting_speed() -> None:
    module = script("ti6al4v_ducobu")
    runs = {variant.name: variant for variant in module.STUDY.variants}
    for speed, coefficient, partition in ((5, 0.24, 0.0), (10, 0.21, 0.2), (40, 0.17, 0.5)):
        case = cutting_case(DEMOS / "ti6al4v_ducobu", planned_changes(runs[f"40um_{speed}"]))
        assert not isinstance(case.contact.friction, float)
        law = case.contact.friction.model_dump()
        assert (law["coefficient"], law["shear_limit"], law["shear_factor"]) == (coefficient, 576.0, None)
        assert case.contact.heat_partition == pytest.approx(partition)


def test_measured_forces_are_per_width(tmp_path: Path) -> None:
    path = tmp_path / "measured.toml"
    path.write_text(
        'width = 3.0\nsource = "x"\n[[cut]]\nname = "a"\ncutting_force = {value = 1500.0, scatter = 15.0}\n'
        "thrust_force = {value = 900.0, scatter = 9.0}\nchip_ratio = {value = 2.0, scatter = 0.1}\n",
        encoding="utf-8",
    )
    assert load_measurements(path)["a"] == {
        "cutting_force": Figure(500.0, 5.0),
        "thrust_force": Figure(300.0, 3.0),
        "chip_ratio": Figure(2.0, 0.1),
    }
    path.write_text('width = 0.0\nsource = "x"\ncut = []\n', encoding="utf-8")
    with pytest.raises(InputError, match="width"):
        load_measurements(path)


def test_uncertainty_of_a_first_order_error() -> None:
    # value = 100 + 2 h: the fine value at h = 1 is 2 off, the index 1.25 times that.
    assert convergence_index(102.0, 104.0, 2.0) * 102.0 == pytest.approx(2.5)
    assert convergence_index(102.0, 100.0 + 2.0 * math.sqrt(2.0), math.sqrt(2.0)) * 102.0 == pytest.approx(
        2.5
    )
    assert half_width(100.0, [0.03, 0.04], 6.0) == pytest.approx(13.0)
    assert half_width(100.0, [math.nan, 0.04], 1.5) == pytest.approx(5.0)


def test_differences_are_relative_to_the_measurement() -> None:
    names = ("cutting_force", "thrust_force", "chip_ratio")
    measured = {cut: {name: Figure(100.0, 1.0) for name in names} for cut in ("a", "b", "not run")}
    predictions = {
        "a": {name: Figure(90.0, 1.0) for name in names},
        "b": {name: Figure(120.0, 1.0) for name in names},
    }
    found = differences(predictions, measured)
    assert found["a"]["cutting_force"] == pytest.approx(-0.1)
    assert set(found) == {"a", "b"}
    assert mean_and_largest(found)["thrust_force"] == pytest.approx({"mean": 0.15, "largest": 0.2})


def test_forces_on_the_parts_of_the_tool() -> None:
    """Pressure 1000 (1.2 c − s) MPa up the rake face to s = c: the resultant is 700 c² N/mm, friction a tenth."""
    contact, rake, speed = 0.15, 6.0, 1000.0
    frame = outline_frame(rake, thickness=0.2, contact=contact)
    shares = force_shares(frame, frame.tool[0], speed)
    normal, gamma = 700.0 * contact**2, math.radians(rake)
    # The workpiece stands still and the tool advances: with a positive rake it slides up the face and lifts the tool.
    expected = normal * np.array(
        [math.cos(gamma) + 0.1 * math.sin(gamma), 0.1 * math.cos(gamma) - math.sin(gamma)]
    )
    assert shares.rake == pytest.approx(expected, rel=0.02)
    assert shares.tip[0] > 0.0
    assert shares.flank == pytest.approx([0.0, 0.0])
