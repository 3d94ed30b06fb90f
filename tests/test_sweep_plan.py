"""What sweeps expand to, what they refuse, and what they list before anything runs."""

from __future__ import annotations

import re
import string
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import written_case, written_study

from pfemcut.cli.main import status
from pfemcut.sweep import run as run_module
from pfemcut.sweep.plan import LONGEST_NAME, name_of, short_keys, value_text, variants_of
from pfemcut.sweep.pool import Ended
from pfemcut.sweep.prepare import prepared
from pfemcut.sweep.study_file import read_plan, value_list
from pfemcut.sweep.units import units_of


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    return written_case(tmp_path)


# What a sweep expands to

keys = st.lists(
    st.sampled_from(["cutting.speed", "tool.rake", "mesh.growth", "a.b.growth"]),
    unique=True,
    min_size=2,
    max_size=4,
)
numbers = st.lists(st.floats(-1e6, 1e6).map(lambda x: x + 0.0), unique=True, min_size=1, max_size=4)


@given(st.data())
def test_grid_and_zipped_lists_give_every_combination_once(data: st.DataObject) -> None:
    names = data.draw(keys)
    cut = data.draw(st.integers(0, len(names)))
    grid = {name: data.draw(numbers) for name in names[:cut]}
    rows = data.draw(st.integers(1, 4))
    column = st.lists(st.floats(-1e6, 1e6).map(lambda x: x + 0.0), unique=True, min_size=rows, max_size=rows)
    zipped = {name: data.draw(column) for name in names[cut:]}
    variants = variants_of(grid, zipped)
    together = list(zip(*zipped.values(), strict=True)) or [()]
    wanted = [(*values, *row) for values in product(*grid.values()) for row in together]
    assert [tuple(variant.values.values()) for variant in variants] == wanted
    assert all(tuple(variant.values) == (*grid, *zipped) for variant in variants)
    assert len({variant.name for variant in variants}) == len(wanted)


@settings(max_examples=40)
@given(
    st.lists(st.one_of(st.text(max_size=200), st.floats(allow_nan=False)), unique_by=value_text, max_size=8)
)
def test_names_are_safe_stable_and_differ(values: list[Any]) -> None:
    names = [name_of({"tool.rake": value}, {"tool.rake": "rake"}) for value in values]
    assert len(set(names)) == len(names)
    for name in names:
        assert len(name) <= LONGEST_NAME
        assert set(name) <= set(string.ascii_letters + string.digits + "._+-=")
        assert name.startswith("rake=")


def test_names_are_readable() -> None:
    grid = {"cutting.speed": [1000, 2000.5], "contact.friction": [0.2], "workpiece.material": ["voce_steel"]}
    assert [variant.name for variant in variants_of(grid, {})] == [
        "speed=1000_friction=0.2_material=voce_steel",
        "speed=2000.5_friction=0.2_material=voce_steel",
    ]
    (tiny,) = variants_of({"time.step": [1e-7]}, {})
    assert tiny.name == "step=1e-07"
    (table,) = variants_of({"contact.friction": [{"law": "tresca"}]}, {})
    assert re.fullmatch(r"friction=law-tresca_[0-9a-f]{6}", table.name)
    assert short_keys({"a.size", "b.size", "b.rake"}) == {
        "a.size": "a.size",
        "b.size": "b.size",
        "b.rake": "rake",
    }


def test_an_extended_grid_finds_its_runs_again() -> None:
    few = {variant.name for variant in variants_of({"a.b": [1, "x/y"], "a.c": [3]}, {})}
    assert few < {variant.name for variant in variants_of({"a.b": [0, 1, "x/y"], "a.c": [3, 4]}, {})}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1,2.5,1e-7", [1, 2.5, 1e-7]),
        ("aisi4340, 42cd4", ["aisi4340", "42cd4"]),
        ("true,false", [True, False]),
        ('{law="tresca", factor=0.5},0.2', [{"law": "tresca", "factor": 0.5}, 0.2]),
        ("a,[1,2]", ["a", [1, 2]]),
        ("'a,b',c", ["a,b", "c"]),
        ("", []),
    ],
)
def test_lists_of_the_command_line(text: str, values: list[Any]) -> None:
    assert value_list(text) == values


def test_a_sweep_file_says_the_same_with_bare_and_quoted_keys(case_file: Path) -> None:
    bare = 'case = "case.toml"\n[set]\ncutting.travel = 0.01\n[grid]\ntool.rake = [0.0, 6.0]\n'
    quoted = 'case = "case.toml"\n[set]\n"cutting.travel" = 0.01\n[grid]\n"tool.rake" = [0.0, 6.0]\n'
    plans = [read_plan(written_study(case_file.parent, text)) for text in (bare, quoted)]
    assert plans[0] == plans[1]
    same = read_plan(
        case_file, vary=["tool.rake=0.0,6.0"], common=["cutting.travel=0.01"], output=plans[0].output
    )
    assert same == plans[0]
    assert plans[0].output == Path("out/study")


def test_a_parameter_that_a_variant_leaves_alone_has_the_value_of_the_case(case_file: Path) -> None:
    study = written_study(
        case_file.parent,
        'case = "case.toml"\n[[variant]]\ntool.rake = 6.0\n[[variant]]\nname = "hot"\nworkpiece.temperature = 500.0\n'
        "tool.tip_radius = 0.03\n[[variant]]\nworkpiece.material.hardening.C = 0.0\n"
        '[[variant]]\n"contact.friction" = {law = "shear", shear_factor = 0.5}\n',
    )
    variants = prepared(read_plan(study))
    assert [variant.parameters["tool.rake"] for variant in variants[:2]] == [6.0, 0.0]
    assert [variant.parameters["tool.tip_radius"] for variant in variants[:2]] == [0.025, 0.03]
    constants = [variant.parameters["workpiece.material.hardening.C"] for variant in variants]
    assert constants == [0.014, 0.014, 0.0, 0.014]
    assert [variant.parameters["contact.friction"] for variant in variants[2:]] == [
        0.0,
        {"law": "shear", "shear_factor": 0.5},
    ]
    assert variants[1].directory.name == "hot"
    assert units_of(variants[0].case, ["cutting.speed", "tool.tip_radius", "contact.friction", "x.y"]) == {
        "cutting.speed": "mm/s",
        "tool.tip_radius": "mm",
    }


# What it refuses


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--vary", "cutting.speed=1000,-2,-3"], "variant speed=-2: [cutting] speed: given -2"),
        (
            ["--vary", "tool.rake=0,6", "--set", "cutting.depht=1"],
            "variant rake=0 (and 1 more): [cutting] depht: unknown key; did you mean 'depth'?",
        ),
        (
            ["--vary", "tool.rake.x=1"],
            "variant x=1: given 'tool.rake.x', but 'tool.rake' is not a table",
        ),
        (["--vary", "workpiece.material=granite"], "variant material=granite: [workpiece] material"),
        (["--vary", "tool.rake"], "--vary: given 'tool.rake', must be section.key=value,value,..."),
        (["--vary", "tool.rake="], "'tool.rake' has no values"),
        (["--vary", "tool.rake=1,1"], "two variants are called 'rake=1'"),
        (["--vary", "tool.rake=1", "--vary", "tool.rake=2"], "--vary: 'tool.rake' is given twice"),
        (
            ["--vary", "tool.rake=1", "--zip", "tool.rake=2"],
            "'tool.rake' is varied in the grid and in the zipped",
        ),
        (["--zip", "tool.rake=1,2", "--zip", "cutting.speed=1"], "must have the same length"),
        (["--vary", "tool.rake=1", "--set", "tool.rake=2"], "--set: 'tool.rake' is varied"),
        ([], "nothing to vary: give --vary"),
        (["--vary", "tool.rake=1,2", "--only", "rake=11"], "--only: unknown variant 'rake=11'; did you mean"),
        (["--vary", "tool.rake=1,2", "--index", "2"], "--index: given 2, must be from 0 to 1"),
        (["--vary", "tool.rake=1", "--index", "0", "--collect"], "exclude each other"),
        (["--vary", "tool.rake=1", "-j", "0"], "-j"),
    ],
)
def test_bad_input_is_named_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    case_file: Path,
    options: list[str],
    words: str,
) -> None:
    monkeypatch.setattr(run_module, "run_pool", not_to_be_called)
    output = case_file.parent / "sweep"
    assert status(["sweep", str(case_file), "-o", str(output), *options]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert not output.exists()


def not_to_be_called(*_: object) -> Ended:
    raise AssertionError("nothing may run")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('case = "nowhere.toml"\n[grid]\ntool.rake = [1.0]\n', "nowhere.toml: no such file"),
        ('case = "case.toml"\n[grids]\n', "grids: unknown key; did you mean 'grid'?"),
        ('case = "case.toml"\n', "study.toml: nothing to vary"),
        ('case = "case.toml"\n[grid]\ntool.rake = 1.0\n', "[grid] tool.rake: given 1.0, must be a list"),
        (
            'case = "case.toml"\n[set]\ntool.rake = 1.0\n[grid]\ntool.rake = [1.0]\n',
            "[set] tool.rake: is varied",
        ),
        ('case = "case.toml"\n[[variant]]\nname = "../up"\ntool.rake = 1.0\n', "name: given '../up'"),
        ('case = "case.toml"\n[[variant]]\nname = "same"\n', "[variant[0]] changes nothing"),
        (
            'case = "case.toml"\nfigures = ["cuting_force"]\n[grid]\ntool.rake = [1.0]\n',
            "figures: unknown 'cuting_force'; did you mean 'cutting_force'?",
        ),
    ],
)
def test_a_wrong_sweep_file_is_named(
    capsys: pytest.CaptureFixture[str], case_file: Path, text: str, words: str
) -> None:
    assert status(["sweep", str(written_study(case_file.parent, text))]) == 2
    assert words in capsys.readouterr().err


def test_a_sweep_under_mpirun_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], case_file: Path
) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    assert status(["sweep", str(case_file), "--vary", "tool.rake=1"]) == 2
    assert "without mpirun" in capsys.readouterr().err


def test_the_list_has_numbers_names_and_warnings(
    capsys: pytest.CaptureFixture[str], case_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_module, "run_pool", not_to_be_called)
    assert status(["sweep", str(case_file), "--vary", "tool.rake=0,6", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[:2]] == [["0", "rake=0", "new"], ["1", "rake=6", "new"]]
    assert any(line.startswith("warning: variant rake=0 (and 1 more): [cutting] travel") for line in lines)
