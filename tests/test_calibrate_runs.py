"""A calibration's folders, files and refusals, without any cut."""

from __future__ import annotations

import json
import pickle
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from problems import SHORT_CUT

from pfemcut.calibrate import plot
from pfemcut.case.load import resolved_toml
from pfemcut.cli.main import status
from pfemcut.sweep import run as run_module
from pfemcut.sweep.pool import Command, Ended, Watcher


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


def pool_of(
    model: Callable[..., tuple[float, float]],
    left: list[int],
    *,
    steady: bool = True,
    warned: Sequence[str] = (),
    fails: Callable[[str], bool] = lambda name: False,
) -> Callable[..., Ended]:
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
            if fails(variant.name):
                statuses[command.name] = 1
                watcher.ended(variant.name, 1)
                continue
            contact, speed = variant.case.contact, variant.case.cutting.speed
            cutting, thrust = model(contact.friction, speed, contact.heat_partition)
            content = {
                "finished": True,
                "ending": "done",
                "warnings": list(warned),
                "steady": {"value": steady, "unit": "-"},
                "steps": {"value": 9, "unit": "-"},
                "wall_time": {"value": 9.0, "unit": "s"},
                "window": [0.2, 0.5],
                "travel": 0.5,
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
    # The last line is a command, and none of the summaries has anything to warn of.
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith(f"pfemcut run {case} --set contact.friction=0.")
    assert not whole["warnings"]

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
    assert "the run of another case is there (tool.rake: 0.0 -> 6.0)" in capsys.readouterr().err


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


def test_runs_that_were_unsteady_or_warn_of_something_are_told_of(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["calibrate", str(case_in(tmp_path)), str(measured_in(tmp_path, MEASURED))]
    command += ["--fit", "contact.friction=0.05:0.6", "-o", str(tmp_path / "out")]
    pool = pool_of(forces, [1000], steady=False, warned=["the chip was too short"])
    monkeypatch.setattr(run_module, "run_pool", pool)
    assert status(command) == 0
    content = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    ends = [f"friction={content['parameters'][0]['value']:g}_speed={speed}" for speed in (1000, 2000)]
    wanted = [f"{name}: {text}" for name in ends for text in ("not steady", "the chip was too short")]
    assert content["warnings"] == wanted
    assert [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning: ")] == [
        f"warning: {text}" for text in wanted
    ]


def test_all_folders_of_a_point_that_is_not_computed_are_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = MEASURED + "cutting_force,130,3,N/mm,a,3000\n"
    command = ["calibrate", str(case_in(tmp_path)), str(measured_in(tmp_path, text))]
    command += ["--fit", "contact.friction=0.05:0.6", "-o", str(tmp_path / "out")]
    pool = pool_of(forces, [1000], fails=lambda name: "speed=1000" not in name)
    monkeypatch.setattr(run_module, "run_pool", pool)
    assert status(command) == 1
    said = capsys.readouterr().err
    runs = tmp_path / "out" / "runs"
    assert all(f"{runs}/friction=0.15_speed={speed}" in said for speed in (2000, 3000))
    assert "speed=1000" not in said


def test_a_value_that_the_cuts_of_the_file_would_replace_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [0]))
    command = ["calibrate", str(case_in(tmp_path)), str(measured_in(tmp_path, MEASURED))]
    command += ["--fit", "contact.friction=0.05:0.6", "-o", str(tmp_path / "out")]
    assert status([*command, "--set", "cutting.speed=500"]) == 2
    assert "--set: 'cutting.speed' would have no effect" in capsys.readouterr().err
    assert status([*command, "--set", "contact.friction.law=coulomb"]) == 2
    assert "'contact.friction.law' is fitted, by 'contact.friction'" in capsys.readouterr().err


def test_a_parameter_is_fitted_in_the_material_that_a_cut_gives(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The cut's material must not replace the fitted constant in it."""
    found = []

    def run(commands: Sequence[Command], jobs: int, watcher: Watcher) -> Ended:
        found.extend(pickle.loads(command.given).variant.material.name for command in commands)
        found.extend(pickle.loads(command.given).variant.parameters for command in commands)
        hardening = [pickle.loads(command.given).variant.material.hardening for command in commands]
        found.extend(hardening)
        return Ended({}, 2)

    monkeypatch.setattr(run_module, "run_pool", run)
    text = MEASURED.replace("cutting.speed", "workpiece.material").replace("1000", "aisi4340")
    command = ["calibrate", str(case_in(tmp_path)), str(measured_in(tmp_path, text.replace("2000", "42cd4")))]
    command += ["--fit", "material.hardening.A=500:900:612", "-o", str(tmp_path / "out")]
    assert status(command) == 1
    assert [each.A for each in found[-2:]] == [612.0, 612.0]


def test_the_picture_takes_figures_that_were_measured_as_zero(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = MEASURED.replace("thrust_force,60,3", "thrust_force,0,3")
    monkeypatch.setattr(run_module, "run_pool", pool_of(forces, [1000]))
    drawn = []
    monkeypatch.setattr(plot, "write_picture", lambda path, figure: drawn.append(figure))
    command = ["calibrate", str(case_in(tmp_path)), str(measured_in(tmp_path, text))]
    command += ["--fit", "contact.friction=0.05:0.6", "-o", str(tmp_path / "out")]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert status(command) == 0
    axes = drawn[0].axes[0]
    assert all(np.isfinite(line.get_xdata()).all() and len(line.get_xdata()) <= 2 for line in axes.lines)
    assert any("std from it" in text.get_text() for text in axes.texts)
    assert len(axes.get_yticks()) == 3
