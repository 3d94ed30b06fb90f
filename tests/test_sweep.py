"""Sweeps: what they expand to and refuse, the pool of processes, and short cuts run side by side."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import signal
import string
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from io import StringIO
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import SHORT_CUT

from pfemcut.cli.main import status
from pfemcut.output.directory import OutputError
from pfemcut.results.history import CORE_COLUMNS
from pfemcut.sweep import run as run_module
from pfemcut.sweep.display import Bars, Lines, last_measures
from pfemcut.sweep.plan import LONGEST_NAME, name_of, short_keys, variants_of
from pfemcut.sweep.plot import draw, grouped
from pfemcut.sweep.pool import Command, Ended, Watcher, run_pool
from pfemcut.sweep.prepare import State, prepared, states
from pfemcut.sweep.results import Outcome
from pfemcut.sweep.study_file import read_plan, value_list
from pfemcut.sweep.units import units_of
from pfemcut.sweep.worker import _claim

CASE: Mapping[str, Mapping[str, Any]] = {
    **SHORT_CUT,
    "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.008},
    "mesh": {
        "tip_size": 0.01,
        "shear_zone_size": 0.03,
        "chip_size": 0.03,
        "surface_size": 0.03,
        "far_size": 0.6,
        "growth": 0.3,
    },
    "time": {"step": 6e-8},
    "output": {"figures": False},
}
"""Forty steps of a very coarse cut."""

FRICTIONS = ("friction=0", "friction=0.2")
STUDY = """\
case = "case.toml"
[grid]
contact.friction = [0.0, 0.2]
[[variant]]
name = "fails"
time.smallest_step_fraction = 1.0
solver.max_iterations = 2
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    return written_case(tmp_path)


def written_case(folder: Path, **sections: Mapping[str, Any]) -> Path:
    path = folder / "case.toml"
    table = {name: {**CASE.get(name, {}), **sections.get(name, {})} for name in {**CASE, **sections}}
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def written_study(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def rows_in(folder: Path) -> dict[str, dict[str, str]]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        return {row["variant"]: row for row in csv.DictReader(file)}


def json_in(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


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
@given(st.lists(st.one_of(st.text(max_size=200), st.floats(allow_nan=False)), unique_by=str, max_size=8))
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


def test_a_variant_that_runs_already_is_left_to_its_process(tmp_path: Path) -> None:
    held = _claim(tmp_path)
    with pytest.raises(OutputError, match="another process is running this variant"):
        _claim(tmp_path)
    os.close(held)
    os.close(_claim(tmp_path))


# The pool


def python(tmp_path: Path, name: str, code: str) -> Command:
    return Command(name, (sys.executable, "-c", code), b"given", tmp_path / name / "log")


class Notes(Watcher):
    """Remembers what the pool told; ``event`` is called when time passes."""

    def __init__(self, event: Callable[[Sequence[str]], None] = lambda running: None) -> None:
        self.event = event
        self.most = 0
        self.order: list[str] = []
        self.stops = 0

    def started(self, name: str) -> None:
        self.order.append(name)

    def stopping(self) -> None:
        self.stops += 1

    def passing(self, running: Sequence[str]) -> None:
        self.most = max(self.most, len(running))
        self.event(running)


def test_the_pool_runs_all_a_few_at_a_time_and_a_failure_stops_no_other(tmp_path: Path) -> None:
    code = "import os, sys, time; print(sys.stdin.read(5), os.environ['OMP_NUM_THREADS']); time.sleep(0.3); "
    commands = [python(tmp_path, f"p{i}", code + f"sys.exit({i % 2})") for i in range(4)]
    commands.append(python(tmp_path, "dead", "import os; os.kill(os.getpid(), 9)"))
    notes = Notes()
    ended = run_pool(commands, 2, notes)
    assert ended == Ended({"p0": 0, "p1": 1, "p2": 0, "p3": 1, "dead": -9}, 0)
    assert notes.order == ["p0", "p1", "p2", "p3", "dead"]
    assert notes.most == 2
    assert (tmp_path / "p3" / "log").read_text() == "given 1\n"


PATIENT = """
import pathlib, signal, sys, time
times = []
def note(number, frame): times.append(number)
for number in (signal.SIGINT, signal.SIGTERM): signal.signal(number, note)
pathlib.Path({ready!r}).touch()
while not times or {deaf}: time.sleep(0.01)
time.sleep(0.3)
print(len(times))
sys.exit(1)
"""


def patient(tmp_path: Path, name: str, *, deaf: bool = False) -> Command:
    """A process that ends, with status 1, some time after a signal; or never."""
    (tmp_path / name).mkdir()
    return python(tmp_path, name, PATIENT.format(ready=str(tmp_path / name / "ready"), deaf=deaf))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_handed_on_once_and_waits_for_the_end(tmp_path: Path, number: signal.Signals) -> None:
    sent: list[int] = []

    def event(running: Sequence[str]) -> None:
        if not sent and all((tmp_path / name / "ready").exists() for name in ("a", "b")):
            sent.append(number)
            os.kill(os.getpid(), number)

    commands = [patient(tmp_path, name) for name in ("a", "b", "c")]
    notes = Notes(event)
    assert run_pool(commands, 2, notes) == Ended({"a": 1, "b": 1}, number)
    assert notes.stops == 1
    assert [(tmp_path / name / "log").read_text() for name in ("a", "b")] == ["1\n", "1\n"]


def test_a_second_signal_kills(tmp_path: Path) -> None:
    def event(_: Sequence[str]) -> None:
        if (tmp_path / "a" / "ready").exists():
            os.kill(os.getpid(), signal.SIGINT)

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_pool([patient(tmp_path, "a", deaf=True)], 1, Notes(event))
    assert time.monotonic() - begun < 20.0


def test_a_worker_stops_when_the_sweep_is_gone() -> None:
    code = (
        "from pfemcut.sweep.worker import _stop_when_alone; import time; _stop_when_alone(); time.sleep(60)"
    )
    done = subprocess.run([sys.executable, "-c", code], stdin=subprocess.DEVNULL, timeout=50, check=False)
    assert done.returncode == -signal.SIGTERM


# What a waiting user sees


def test_a_history_that_is_being_written_shows_its_last_whole_row(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    assert last_measures(path) is None
    header = ",".join([*CORE_COLUMNS, "own"]) + "\n"
    path.write_text(header)
    assert last_measures(path) is None
    rows = [",".join([str(step), *["0.125"] * (len(CORE_COLUMNS) - 2), "9", "7"]) for step in range(1, 300)]
    path.write_text(header + "\n".join(rows))  # no line break at the end: a row that is not whole
    measures = last_measures(path)
    assert measures is not None
    assert (measures.step, measures.cutting_force, measures.nodes) == (298, 0.125, 9)


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [StringIO(), Terminal()])
def test_each_variant_that_ended_gets_a_line(tmp_path: Path, stream: StringIO) -> None:
    variants: Any = [SimpleNamespace(name=name, directory=tmp_path / name, end=1.0) for name in ("a", "b")]
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "run.log").write_text("fine\nout of memory\n\n")
    (tmp_path / "a").mkdir()
    summary = {"cutting_force": {"mean": 151.25, "std": 1.0, "unit": "N/mm"}}
    (tmp_path / "a" / "summary.json").write_text(json.dumps(summary))
    with (Bars if stream.isatty() else Lines)(variants, stream) as shown:
        for name, code in (("a", 0), ("b", -9)):
            shown.started(name)
            shown.passing([name])
            shown.ended(name, code)
    text = " ".join(stream.getvalue().split())
    assert "[1/2] a: finished Fc 151.2 N/mm, 0:00:00" in text
    assert "failed with status -9" in text
    assert "out of memory" in text
    assert ("\x1b" in text) == stream.isatty()


# The plot


def outcome(force: float, **parameters: Any) -> Outcome:
    summary = {"cutting_force": {"mean": force, "std": 1.0}, "steady": {"value": force > 2.0}}
    variant: Any = SimpleNamespace(parameters=parameters)
    return Outcome(variant, "finished", summary)


def test_lines_of_the_plot_are_the_values_that_the_first_parameter_does_not_explain() -> None:
    zipped = [outcome(1.0, a=i, b=2 * i, c=c) for i in range(3) for c in ("x", "y")]
    lines = grouped(zipped, "a", ["b", "c"])
    assert {label: len(members) for label, members in lines.items()} == {"c = x": 3, "c = y": 3}
    assert list(grouped(zipped[::2], "a", ["b", "c"])) == [""]


def test_the_plot_has_a_panel_a_figure_with_means_and_deviations() -> None:
    outcomes = [outcome(10.0 * b + a, **{"cutting.speed": a, "b": b}) for a in (3, 1, 2) for b in (0, 1)]
    figure = draw(outcomes, ["cutting_force"], ["cutting.speed", "b"], {"cutting.speed": "mm/s"})
    (axes,) = figure.axes
    assert axes.get_title() == "Cutting force (N/mm)"
    assert axes.get_xlabel() == "cutting.speed (mm/s)"
    drawn = [container.lines[0].get_xydata().tolist() for container in axes.containers]
    assert drawn == [[[1, 1], [2, 2], [3, 3]], [[1, 11], [2, 12], [3, 13]]]
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[:2] == ["b = 0", "b = 1"]
    assert "open: not steady" in words


def test_the_plot_of_names_has_them_as_ticks() -> None:
    outcomes = [outcome(5.0, material=name) for name in ("steel", "titanium")]
    (axes,) = draw(outcomes, ["cutting_force"], ["material"], {}).axes
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["steel", "titanium"]


# Short cuts side by side


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a study of two cuts, run two at a time, and a variant that can't converge."""
    folder = tmp_path_factory.mktemp("study")
    written_case(folder)
    study = written_study(folder, STUDY)
    assert status(["sweep", str(study), "-o", str(folder / "two"), "-j", "2"]) == 1
    return folder


def test_a_variant_that_fails_stops_no_other_and_stands_in_the_table(finished: Path) -> None:
    rows = rows_in(finished / "two")
    assert {name: row["status"] for name, row in rows.items()} == {
        **dict.fromkeys(FRICTIONS, "finished"),
        "fails": "stopped",
    }
    assert "no convergence" in rows["fails"]["warnings"]
    assert "no convergence" in (finished / "two" / "fails" / "run.log").read_text()
    assert (finished / "two" / "results.png").stat().st_size > 10_000


def test_the_table_has_the_figures_of_the_summaries(finished: Path) -> None:
    content = json_in(finished / "two" / "results.json")
    assert content["parameters"] == [
        "contact.friction",
        "time.smallest_step_fraction",
        "solver.max_iterations",
    ]
    assert {"command", "date", "version", "commit"} <= set(content["recorded"])
    for name, row in rows_in(finished / "two").items():
        summary = json_in(finished / "two" / name / "summary.json")
        (entry,) = (entry for entry in content["variants"] if entry["name"] == name)
        figures = {
            key: value for key, value in summary.items() if isinstance(value, dict) and "unit" in value
        }
        for figure in ("steady", "steps", "wall_time"):
            del figures[figure]
        assert figures
        assert entry["figures"] == figures
        for figure, value in figures.items():
            assert float(row[figure]) == value.get("mean", value.get("value"))
            assert row.get(f"{figure}_std", "") == (str(value["std"]) if "std" in value else "")
        assert float(row["wall_time"]) == summary["wall_time"]["value"]
        assert row["warnings"] == "; ".join(summary["warnings"])
    inputs = tomllib.loads((finished / "two" / "friction=0.2" / "inputs.resolved.toml").read_text())
    assert inputs["contact"]["friction"] == 0.2


def test_a_second_call_runs_nothing_and_a_changed_case_is_an_error(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(finished / "two", tmp_path / "two")
    started: list[str] = []

    def pool(commands: Sequence[Command], jobs: int, watcher: Watcher) -> Ended:
        started.extend(command.name for command in commands)
        return Ended({}, 0)

    monkeypatch.setattr(run_module, "run_pool", pool)
    same = ["sweep", str(finished / "case.toml"), "-o", str(tmp_path / "two")]
    assert status([*same, "--vary", "contact.friction=0.0,0.2"]) == 0
    assert started == []
    said = capsys.readouterr().out
    assert "2 variants" in said
    assert ": 2 finished" in said
    assert "not of this sweep, left alone: fails" in said

    changed = [*same, "--vary", "contact.friction=0.0,0.2", "--set", "cutting.depth=0.11"]
    assert status(changed) == 2
    assert (
        "variant friction=0 (and 1 more): its folder holds the run of another case (cutting.depth: 0.1 -> 0.11)"
        in capsys.readouterr().err
    )
    shorter = [*same, "--vary", "contact.friction=0.0,0.2", "--set", "cutting.travel=0.004"]
    assert status(shorter) == 2
    assert "cutting.travel: 0.008 -> 0.004" in capsys.readouterr().err
    assert started == []
    assert status([*changed, "--collect"]) == 1
    assert {row["status"] for row in rows_in(tmp_path / "two").values()} == {"of another case"}
    assert status([*changed, "--overwrite"]) == 1
    longer = [*same, "--vary", "contact.friction=0.0,0.2,0.4", "--set", "cutting.travel=0.01"]
    assert status(longer) == 1
    assert started == [*FRICTIONS, *FRICTIONS, "friction=0.4"]
    assert ": 1 new, 2 goes on" in capsys.readouterr().out


def test_an_interrupted_sweep_goes_on_and_gives_what_runs_side_by_side_give(
    finished: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One at a time, interrupted, gone on with by name and by number: bit for bit the same, as each has one thread."""
    one = finished / "one"
    command = ["sweep", str(finished / "case.toml"), "--vary", "contact.friction=0.0,0.2", "-o", str(one)]
    history = one / "friction=0" / "history.csv"

    def interrupt() -> None:
        while not history.is_file() or history.read_bytes().count(b"\n") < 4:
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    assert status([*command, "-j", "1"]) == 1
    assert "stopped by SIGINT, 0 of 2 variants finished" in capsys.readouterr().err
    assert not (one / "friction=0.2").exists()
    plan = read_plan(finished / "case.toml", vary=["contact.friction=0.0,0.2"], output=one)
    assert states(prepared(plan)) == (State.INTERRUPTED, State.NEW)

    assert status([*command, "--only", "friction=0"]) == 0
    assert [session["resumed"] for session in json_in(history.parent / "sessions.json")] == [False, True]
    assert not (one / "results.csv").exists()
    assert status([*command, "--collect"]) == 1
    assert {name: row["status"] for name, row in rows_in(one).items()} == {
        "friction=0": "finished",
        "friction=0.2": "not finished",
    }
    assert status([*command, "--index", "1"]) == 0
    assert status([*command, "--collect"]) == 0
    for name in FRICTIONS:
        assert (one / name / "history.csv").read_bytes() == (
            finished / "two" / name / "history.csv"
        ).read_bytes()
    assert status([*command, "--index", "1"]) == 0
    assert "friction=0.2: finished before" in capsys.readouterr().out
