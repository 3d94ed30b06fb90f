"""Recorded results stay small and whole, and say where they come from."""

from __future__ import annotations

import csv
import json
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from pfemcut.inputs import InputError
from pfemcut.method import RunStopped
from pfemcut.validation import study as study_module
from pfemcut.validation.provenance import provenance
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.validation.study import Outcome, Study, Variant, run_study, write_table

ROOT = Path(__file__).parent.parent
SCRIPTS = sorted((ROOT / "demos").glob("*/*.py"))


def rows_of(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


@pytest.mark.parametrize(("count", "kept"), [(3, 3), (400, 400), (5001, 400), (0, 0)])
def test_thinned_history_keeps_first_and_last_row(tmp_path: Path, count: int, kept: int) -> None:
    write_thinned(tmp_path / "history.csv", {"step": np.arange(float(count)), "force": np.full(count, 1 / 3)})
    header, *rows = rows_of(tmp_path / "history.csv")
    assert header == ["step", "force"]
    assert len(rows) == kept
    if rows:
        assert (rows[0][0], float(rows[-1][0]), rows[-1][1]) == ("0", count - 1.0, "0.333333")


def test_pictures_are_brought_below_the_limit_and_small_ones_copied(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (300, 400, 3), dtype=np.uint8)
    Image.fromarray(noise).save(tmp_path / "noise.png")
    copy_picture(tmp_path / "noise.png", tmp_path / "results" / "noise.png", limit=40_000)
    assert (tmp_path / "results" / "noise.png").stat().st_size <= 40_000
    copy_picture(tmp_path / "noise.png", tmp_path / "same.png", limit=10**7)
    assert (tmp_path / "same.png").read_bytes() == (tmp_path / "noise.png").read_bytes()


def test_provenance_names_command_commit_and_machine_but_no_host() -> None:
    found = provenance()
    assert {"command", "date", "version", "commit", "modified", "machine"} <= set(found)
    assert found["machine"]["cores"] >= 1
    assert platform.node() not in json.dumps(found).split('"')


def make_study(tmp_path: Path, seen: list[str]) -> Study:
    def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
        seen.extend(outcome.variant.name for outcome in outcomes)
        rows = [[outcome.variant.name, outcome.mean("cutting_force"), np.nan] for outcome in outcomes]
        write_table(results / "study.csv", "study", ["run", "force", "unknown"], rows)
        return {"forces": [outcome.mean("cutting_force") for outcome in outcomes]}, len(outcomes) == 2

    return Study("study", tmp_path, (Variant("one"), Variant("two", ("time.step=1e-7",))), conclude, 0.5)


def fake_run(case_file: Path, directory: Path, overrides: Sequence[str], start: object) -> None:
    directory.mkdir(parents=True, exist_ok=True)
    summary = {
        "cutting_force": {"mean": 2.0 if "time.step=1e-7" in overrides else 1.0, "std": 0.1, "unit": "N/mm"},
        "steady": {"value": True},
        "steps": {"value": 3},
        "wall_time": {"value": 1.0},
        "ending": "done",
        "finished": True,
        "travel": 0.5,
        "warnings": [],
    }
    (directory / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    (directory / "history.csv").write_text("step,travel\n1,0.5\n", encoding="utf-8")
    if directory.name == "one":
        raise RunStopped("one can't go on")


def test_a_study_runs_all_variants_and_concludes_even_if_one_stops(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study_module, "recorded_run", fake_run)
    seen: list[str] = []
    study = make_study(tmp_path, seen)
    assert run_study(study, ["--only", "two"])
    assert seen == []
    assert run_study(study, ["--resume"])
    assert seen == ["one", "two"]
    assert rows_of(tmp_path / "results" / "study.csv")[1:] == [["one", "1", ""], ["two", "2", ""]]
    stored = json.loads((tmp_path / "results" / "study.json").read_text(encoding="utf-8"))
    assert stored["forces"] == [1.0, 2.0]
    assert stored["runs"]["two"]["changes"] == ["time.step=1e-7"]


def test_a_partial_study_concludes_from_the_runs_that_are_finished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    travels: list[str] = []

    def run(case_file: Path, directory: Path, overrides: Sequence[str], start: object) -> None:
        travels.append(overrides[0])
        fake_run(case_file, directory, overrides, start)

    monkeypatch.setattr(study_module, "recorded_run", run)
    seen: list[str] = []
    study = make_study(tmp_path, seen)
    variants = (study.variants[0], replace(study.variants[1], travel=0.7), Variant("three"))
    study = replace(study, variants=variants, partial=True)
    run_study(study, ["--only", "two", "--only", "one"])
    unfinished = tmp_path / "out_study" / "three"
    unfinished.mkdir()
    (unfinished / "summary.json").write_text('{"finished": false}', encoding="utf-8")
    assert run_study(study, ["--conclude"])
    assert travels == ["cutting.travel=0.7", "cutting.travel=0.5"]
    assert seen == ["one", "two"]


def test_a_short_trial_of_a_study_leaves_the_recorded_results_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study_module, "recorded_run", fake_run)
    run_study(make_study(tmp_path, []), ["--travel", "0.1", "-o", str(tmp_path / "trial")])
    assert not (tmp_path / "results").exists()
    assert (tmp_path / "trial" / "results" / "study.json").exists()


def test_an_unknown_variant_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown variant 'onne'; did you mean 'one'"):
        run_study(make_study(tmp_path, []), ["--only", "onne"])


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_script_of_the_demos_explains_itself(script: Path) -> None:
    done = subprocess.run([sys.executable, str(script), "--help"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "--resume" in done.stdout
