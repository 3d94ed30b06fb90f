"""Calibration on stand-ins with known parameters, and its folders, files and refusals without any cut."""

from __future__ import annotations

import json
import math
import pickle
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from problems import SHORT_CUT

from pfemcut.calibrate.confidence import Confidence, confidence_of
from pfemcut.calibrate.fit import Computed, Controls, Fit, NotComputed, fitted
from pfemcut.calibrate.parameters import Parameter, read_parameters
from pfemcut.case.load import resolved_toml
from pfemcut.cli.main import status
from pfemcut.inputs import InputError
from pfemcut.sweep import run as run_module
from pfemcut.sweep.pool import Command, Ended, Watcher

Array = np.ndarray
Model = Callable[[tuple[float, ...]], Array]

FRICTION = Parameter("contact.friction", 0.05, 0.9, 0.15)
STRENGTH = Parameter("workpiece.material.strength", 200.0, 900.0, 300.0)
UNCERTAINTY = np.array([4.0, 3.0, 4.0, 3.0, 0.4, 0.4])


def merchant(point: tuple[float, ...]) -> Array:
    """Forces per width and shear angle (degrees) of Merchant's shear plane, 0.1 mm deep, at two rake angles."""
    friction, strength = point
    angle = math.atan(friction)
    forces, planes = [], []
    for rake in (0.0, math.radians(10.0)):
        plane = math.pi / 4.0 - 0.5 * (angle - rake)
        resultant = strength * 0.1 / (math.sin(plane) * math.cos(plane + angle - rake))
        forces += [resultant * math.cos(angle - rake), resultant * math.sin(angle - rake)]
        planes.append(math.degrees(plane))
    return np.array([*forces, *planes])


class StandIn:
    """An evaluator that counts, with noise of the model's figures that depends on the point alone."""

    def __init__(self, model: Model, noise: Array | float = 0.0) -> None:
        self.model, self.noise = model, noise
        self.asked: list[tuple[float, ...]] = []

    def __call__(self, points: Sequence[tuple[float, ...]]) -> list[Computed]:
        self.asked += points
        found = []
        for point in points:
            values = self.model(point)
            rng = np.random.default_rng(abs(hash(point)) % 2**32)
            noise = np.broadcast_to(self.noise, values.shape)
            found.append(Computed(values + noise * rng.standard_normal(values.shape), np.array(noise)))
        return found


def calibrated(
    parameters: Sequence[Parameter],
    measured: Array,
    uncertainties: Array,
    model: Model,
    noise: Array | float = 0.0,
    controls: Controls | None = None,
    *,
    assumed: bool = False,
) -> tuple[Fit, Confidence, StandIn]:
    evaluate, controls = StandIn(model, noise), controls or Controls()
    fit = fitted(parameters, measured, uncertainties, evaluate, controls)
    known = confidence_of(fit, parameters, measured, uncertainties, controls.difference, assumed=assumed)
    return fit, known, evaluate


def test_friction_and_strength_of_a_shear_plane_come_back_exactly_from_exact_figures() -> None:
    true = (0.5, 600.0)
    fit, known, evaluate = calibrated((FRICTION, STRENGTH), merchant(true), UNCERTAINTY, merchant)
    assert fit.converged
    # Differences are secants, which end near the minimum: a hundredth of the bounds' range.
    assert fit.point[0] == pytest.approx(true[0], abs=0.01 * 0.85)
    assert fit.point[1] == pytest.approx(true[1], abs=0.01 * 700.0)
    assert [each.low <= value <= each.high for each, value in zip(known.estimates, true, strict=True)] == [
        True,
        True,
    ]
    assert known.warnings == ()
    # Dear runs: few points, none of them twice, and no derivatives for a last step that hardly moves.
    assert len(evaluate.asked) == len(set(evaluate.asked)) <= 14


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Of 100 noisy measurements with noisy models, 95 % intervals of both parameters hold the truth."""
    rng = np.random.default_rng(5)
    true, noise = (0.5, 600.0), 0.3 * UNCERTAINTY
    held = np.zeros(2)
    for _ in range(100):
        measured = merchant(true) + UNCERTAINTY * rng.standard_normal(6)
        _, known, _ = calibrated((FRICTION, STRENGTH), measured, UNCERTAINTY, merchant, noise)
        held += [each.low <= value <= each.high for each, value in zip(known.estimates, true, strict=True)]
    # A share of 95 % of 100 has a standard deviation of 2.2 %; model noise enters search and interval alike.
    assert np.all(held >= 0.88 * 100)
    assert np.all(held <= 99)


def test_intervals_by_hand() -> None:
    """A straight line y = p x: the standard deviation of p is sigma / sqrt(sum x²), without and with model noise."""
    x, sigma = np.array([1.0, 2.0, 3.0]), 0.5
    slope = Parameter("a.b", 0.0, 10.0, 2.0)
    offsets = np.array([0.1, -0.2, 0.1])
    fit, known, _ = calibrated((slope,), 4.0 * x + offsets, np.full(3, sigma), lambda p: p[0] * x)
    (one,) = known.estimates
    assert one.value == pytest.approx(4.0, abs=1e-4)
    assert one.deviation == pytest.approx(sigma / math.sqrt(14.0), rel=1e-6)
    assert one.high - one.value == pytest.approx(1.959964 * one.deviation, rel=1e-5)
    assert known.freedom == 2
    noisy = Fit(fit.point, Computed(fit.computed.values, np.full(3, sigma)), fit.jacobian, True, "", 1)
    (both,) = confidence_of(noisy, (slope,), 4.0 * x, np.full(3, sigma), 0.05, assumed=False).estimates
    assert both.deviation == pytest.approx(math.sqrt(2.0) * one.deviation, rel=1e-6)


def test_a_misfit_that_uncertainties_do_not_explain_widens_intervals_by_students_t() -> None:
    x, slope = np.array([1.0, 2.0, 3.0]), Parameter("a.b", 0.0, 10.0, 2.0)
    measured = 4.0 * x + np.array([3.0, -3.0, 1.0])
    _, known, _ = calibrated((slope,), measured, np.full(3, 0.5), lambda p: p[0] * x)
    (one,) = known.estimates
    residuals = measured - one.value * x
    deviation = math.sqrt(residuals @ residuals / 2.0 / 14.0)
    assert one.deviation == pytest.approx(deviation, rel=1e-4)
    assert one.high - one.value == pytest.approx(4.302653 * deviation, rel=1e-4)
    assert "Student's t, 2 degrees" in known.basis
    assert any("more than the uncertainties explain" in text for text in known.warnings)
    # Uncertainties that are guesses are weights only: the same, whatever they are.
    _, guessed, _ = calibrated((slope,), measured, np.full(3, 50.0), lambda p: p[0] * x, assumed=True)
    assert guessed.estimates[0].deviation == pytest.approx(deviation, rel=1e-4)


def test_parameters_of_which_only_the_product_counts_can_not_be_told_apart() -> None:
    one, two = Parameter("a.a", 0.5, 4.0, 1.0), Parameter("a.b", 0.5, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((one, two), 2.0 * x, np.full(3, 0.02), lambda p: p[0] * p[1] * x)
    assert any("a.a and a.b can't be told apart" in text for text in known.warnings)


def test_nearly_degenerate_parameters_are_warned_of_and_their_intervals_are_wide() -> None:
    one, two = Parameter("a.a", 0.0, 4.0, 1.0), Parameter("a.b", 0.0, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0, 4.0])

    def nearly(p: tuple[float, ...]) -> Array:
        return p[0] * x + p[1] * (x + 0.02 * x**2)

    _, known, _ = calibrated((one, two), nearly((2.0, 1.0)), np.full(4, 0.2), nearly)
    assert known.correlation[0, 1] < -0.95
    assert known.condition > 30.0
    assert sum("can't be told apart" in text for text in known.warnings) == 1
    assert sum("hardly determine" in text for text in known.warnings) == 2


def test_a_parameter_without_effect_is_not_determined() -> None:
    one, two = Parameter("a.a", 0.0, 4.0, 1.0), Parameter("a.b", 0.0, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((one, two), 2.0 * x, np.full(3, 0.2), lambda p: p[0] * x)
    assert math.isinf(known.estimates[1].deviation)
    assert any("hardly determine a.b" in text for text in known.warnings)


def test_warnings_of_bounds_and_of_steps_within_the_noise() -> None:
    slope, x = Parameter("a.b", 0.0, 3.0, 1.0), np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((slope,), 4.0 * x, np.full(3, 0.5), lambda p: p[0] * x)
    assert any("ended at its bound 3" in text for text in known.warnings)
    wide = Parameter("a.b", 0.0, 10.0, 2.0)
    fit, _, _ = calibrated((wide,), 4.0 * x, np.full(3, 0.5), lambda p: p[0] * x)
    noisy = Fit(fit.point, Computed(fit.computed.values, np.full(3, 2.0)), fit.jacobian, True, "", 1)
    texts = confidence_of(noisy, (wide,), 4.0 * x, np.full(3, 0.5), 0.05, assumed=False).warnings
    assert any("its derivatives are noise" in text for text in texts)


def test_differences_stay_within_the_bounds_and_are_taken_over_the_rounded_step() -> None:
    near = Parameter("a.b", 0.0, 1.0, 0.98)
    x = np.array([1.0, 2.0])
    for central in (False, True):
        fit, _, evaluate = calibrated(
            (near,), 0.99 * x, np.full(2, 0.01), lambda p: p[0] * x, controls=Controls(central=central)
        )
        assert all(0.0 <= point[0] <= 1.0 for point in evaluate.asked)
        assert fit.jacobian[:, 0] == pytest.approx(x / 0.01, rel=1e-9)


def test_a_point_that_can_not_be_computed_is_avoided_and_a_start_that_can_not_ends_the_search() -> None:
    slope, x = Parameter("a.b", 0.0, 10.0, 1.0), np.array([1.0, 2.0, 3.0])

    def fails(beyond: float) -> Model:
        return lambda p: np.full(3, math.nan) if p[0] > beyond else p[0] ** 0.5 * x

    # The first step, of the slope at the start, goes beyond.
    fit, _, evaluate = calibrated((slope,), math.sqrt(6.0) * x, np.full(3, 0.1), fails(7.0))
    assert fit.point[0] == pytest.approx(6.0, abs=0.1)
    with pytest.raises(NotComputed):
        calibrated((slope,), 2.0 * x, np.full(3, 0.1), fails(0.5))


# Files and folders


def case_in(folder: Path) -> Path:
    path = folder / "case.toml"
    table = {**SHORT_CUT, "contact": {"friction": 0.15}}
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def measured_in(folder: Path, text: str) -> Path:
    path = folder / "measured.csv"
    path.write_text(text, encoding="utf-8")
    return path


MEASURED = (
    "figure,value,uncertainty,unit,source,cutting.speed\n"
    "cutting_force,150,3,N/mm,a,1000\nthrust_force,60,3,N/mm,a,1000\ncutting_force,140,3,N/mm,a,2000\n"
)


def pool_of(model: Callable[..., tuple[float, float]], left: list[int]) -> Callable[..., Ended]:
    """A pool whose processes write what a run leaves; it is stopped by a signal after ``left[0]`` of them."""

    def run(commands: Sequence[Command], jobs: int, watcher: Watcher) -> Ended:
        statuses = {}
        for command in commands:
            if left[0] == 0:
                return Ended(statuses, 2)
            left[0] -= 1
            variant = pickle.loads(command.given).variant
            watcher.started(variant.name)
            directory = variant.directory
            directory.mkdir(parents=True)
            (directory / "inputs.resolved.toml").write_text(resolved_toml(variant.case, variant.material))
            contact, speed = variant.case.contact, variant.case.cutting.speed
            cutting, thrust = model(contact.friction, speed, contact.heat_partition)
            content = {
                "finished": True,
                "ending": "done",
                "warnings": [],
                "steady": {"value": True, "unit": "-"},
                "cutting_force": {"mean": cutting, "std": 0.5, "unit": "N/mm"},
                "thrust_force": {"mean": thrust, "std": 0.5, "unit": "N/mm"},
            }
            (directory / "summary.json").write_text(json.dumps(content), encoding="utf-8")
            statuses[command.name] = 0
            watcher.ended(variant.name, 0)
        return Ended(statuses, 0)

    return run


def forces(friction: float, speed: float, _: float) -> tuple[float, float]:
    return 120.0 + 100.0 * friction - 0.01 * (speed - 1000.0), 200.0 * friction


def test_a_calibration_that_is_interrupted_goes_on_to_the_same_end(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case, measured = case_in(tmp_path), measured_in(tmp_path, MEASURED)
    command = ["calibrate", str(case), str(measured), "--fit", "contact.friction=0.05:0.6", "-j", "2"]
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [1000]))
    assert status([*command, "-o", str(tmp_path / "whole")]) == 0
    whole = json.loads((tmp_path / "whole" / "calibration.json").read_text(encoding="utf-8"))
    (friction,) = whole["parameters"]
    assert friction["value"] == pytest.approx(0.3, abs=2e-3)
    assert friction["interval"][0] < 0.3 < friction["interval"][1]
    assert [each["cut"] for each in whole["figures"]] == [
        {"cutting.speed": speed} for speed in (1000, 1000, 2000)
    ]
    names = {path.name for path in (tmp_path / "whole" / "runs").iterdir()}
    assert {"friction=0.15_speed=1000", "friction=0.15_speed=2000"} <= names
    assert "fitted: --set contact.friction=" in capsys.readouterr().out

    parts, left = [*command, "-o", str(tmp_path / "parts")], [3]
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, left))
    assert status(parts) == 1
    assert "the same command goes on" in capsys.readouterr().err
    assert len(list((tmp_path / "parts" / "runs").iterdir())) == 3
    left[0] = 1000
    assert status(parts) == 0
    # It ran only what was missing.
    assert 1000 - left[0] == len(names) - 3
    again = json.loads((tmp_path / "parts" / "calibration.json").read_text(encoding="utf-8"))
    assert again["parameters"] == whole["parameters"]
    assert again["figures"] == whole["figures"]
    for name in ("calibration.csv", "calibration.png", "evaluations.csv"):
        assert (tmp_path / "parts" / name).stat().st_size > 0


def test_two_parameters_and_two_cuts_are_told_apart_point_by_point(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Friction and heat partition by forces that depend on both, at two speeds: all points of a derivative at once."""

    def coupled(friction: float, speed: float, share: float) -> tuple[float, float]:
        return 120.0 + 100.0 * friction + 20.0 * share, 200.0 * friction + 0.04 * speed * share

    measured = [("cutting_force", 1000), ("thrust_force", 1000), ("thrust_force", 2000)]
    values = [coupled(0.3, speed, 0.7)[name == "thrust_force"] for name, speed in measured]
    text = "figure,value,uncertainty,unit,cutting.speed\n" + "".join(
        f"{name},{value},2,N/mm,{speed}\n" for (name, speed), value in zip(measured, values, strict=True)
    )
    monkeypatch.setattr(run_module, "run_pool", pool_of(coupled, [1000]))
    command = [
        "calibrate",
        str(case_in(tmp_path)),
        str(measured_in(tmp_path, text)),
        "-o",
        str(tmp_path / "out"),
    ]
    fits = ["contact.friction=0.05:0.6", "contact.heat_partition=0.1:0.9"]
    assert status([*command, "--fit", ",".join(fits)]) == 0
    content = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    assert [each["value"] for each in content["parameters"]] == pytest.approx([0.3, 0.7], abs=2e-3)
    # Of the forces' derivatives, by hand: (100, 200, 200) and (20, 40, 80), over 2 and times the ranges.
    wanted = np.array([[100.0, 20.0], [200.0, 40.0], [200.0, 80.0]]) / 2.0 * [0.55, 0.8]
    assert np.array(content["jacobian"]) == pytest.approx(wanted, rel=1e-4)
    assert content["correlation"]["contact.friction"]["contact.heat_partition"] < -0.8


def test_finished_runs_of_another_case_are_not_taken(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case, measured = case_in(tmp_path), measured_in(tmp_path, MEASURED)
    command = ["calibrate", str(case), str(measured), "--fit", "contact.friction=0.05:0.6"]
    command += ["-o", str(tmp_path / "out")]
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [1000]))
    assert status(command) == 0
    assert status([*command, "--set", "tool.rake=6.0"]) == 2
    assert "another case (tool.rake: 0.0 -> 6.0)" in capsys.readouterr().err


def test_a_figure_that_the_runs_do_not_have_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    measured = measured_in(tmp_path, "figure,value,uncertainty,unit\ntool_max_temperature,900,10,K\n")
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [1000]))
    command = ["calibrate", str(case_in(tmp_path)), str(measured), "--fit", "contact.friction=0.05:0.6"]
    assert status([*command, "-o", str(tmp_path / "out")]) == 2
    assert "has no 'tool_max_temperature'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("fit", "words"),
    [
        ("contact.friction", "given 'contact.friction' without bounds, must be section.key=LOW:HIGH"),
        ("contact.friction=0.1", "must be section.key=LOW:HIGH"),
        ("contact.friction=0.6:0.1", "low = 0.6 must be less than high = 0.1"),
        ("contact.friction=0.1:0.6:0.7", "start = 0.7 must be from 0.1 to 0.6"),
        ("contact.friction=0.2:0.6", "starts at the case's 0.15, outside of 0.2 to 0.6"),
        ("contact.friction=0.1:0.6,contact.friction=0.1:0.6", "'contact.friction' is given twice"),
        ("contact.friction=0.1:9", "variant at the upper bounds: [contact] friction"),
        ("contact.fricton=0.1:0.6", "fricton: unknown key; did you mean 'friction'?"),
        ("workpiece.material=0.1:0.6", "workpiece"),
        ("cutting.speed=100:5000", "'cutting.speed' is fitted"),
        (
            "contact.friction=0.1:0.6,tool.rake=-5:9,cutting.depth=0.05:0.2,mesh.growth=0.1:0.3",
            "can't determine 4",
        ),
        ("nowhere.toml", "nowhere.toml: no such file"),
        ("", "must be section.key=LOW:HIGH"),
    ],
)
def test_bad_parameters_are_named_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str], fit: str, words: str
) -> None:
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [0]))
    case, measured, output = case_in(tmp_path), measured_in(tmp_path, MEASURED), tmp_path / "out"
    assert status(["calibrate", str(case), str(measured), "--fit", fit, "-o", str(output)]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert not output.exists()


def test_measurements_without_uncertainty_need_an_assumed_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "figure,value,unit\ncutting_force,150,N/mm\nthrust_force,60,N/mm\n"
    case, measured = case_in(tmp_path), measured_in(tmp_path, text)
    command = ["calibrate", str(case), str(measured), "--fit", "contact.friction=0.05:0.6"]
    command += ["-o", str(tmp_path / "out")]
    assert status(command) == 2
    assert "no uncertainty of cutting_force, thrust_force: add it, or give" in capsys.readouterr().err
    assert status([*command, "--uncertainty", "2"]) == 2
    assert "--uncertainty: given 2" in capsys.readouterr().err
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [1000]))
    assert status([*command, "--uncertainty", "0.05"]) == 0
    content = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    assert content["uncertainties_assumed"] is True
    assert "Student's t" in content["intervals_from"]


def test_parameters_from_a_file_and_of_the_material(tmp_path: Path) -> None:
    path = tmp_path / "fit.toml"
    path.write_text(
        '"contact.friction" = {low = 0.1, high = 0.6, start = 0.2}\n'
        "[material.hardening]\nA = {low = 500.0, high = 900.0}\n",
        encoding="utf-8",
    )
    friction, hardening = read_parameters([str(path)])
    assert friction == Parameter("contact.friction", 0.1, 0.6, 0.2)
    assert (hardening.key, hardening.low, hardening.high) == ("workpiece.material.hardening.A", 500.0, 900.0)
    assert math.isnan(hardening.start)
    path.write_text("[contact]\nfriction = 0.3\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"contact\.friction: given 0\.3, must be a table"):
        read_parameters([str(path)])
