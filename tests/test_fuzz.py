"""Some hundred mutated inputs of every kind; ``scripts/fuzz_inputs.py`` tries thousands."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from pfemcut.case.particle_count import require_fillable
from pfemcut.cli.main import status
from pfemcut.inputs import LONGEST_LINE, InputError, read_toml
from pfemcut.output.directory import OutputError, prepare_directory
from pfemcut.sweep.study_file import read_plan

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def script() -> ModuleType:
    # As python scripts/fuzz_inputs.py does.
    sys.path.insert(0, str(ROOT / "scripts"))
    return importlib.import_module("fuzz_inputs")


def test_mutated_inputs_are_accepted_as_they_are_or_refused_in_clear_words(script: ModuleType) -> None:
    told: list[str] = []
    counts = script.fuzz(7, range(400), told.append)
    assert not told, "\n".join(told)
    assert {kind.split()[0] for kind, _ in counts} == set(script.inputs.SHARES)
    assert sum(count for (_, outcome), count in counts.items() if outcome == "accepted") > 20


def test_commands_on_damaged_folders_end_in_clear_words(script: ModuleType) -> None:
    told: list[str] = []
    counts = script.fuzz(7, range(20), told.append, what="folders")
    assert not told, "\n".join(told)
    assert {kind for kind, _ in counts} == set(script.folders.COMMANDS)


def test_a_changed_value_would_be_noticed(script: ModuleType) -> None:
    from fuzzing.judgement import Changed, require_same_values

    require_same_values({"a": {"b": [1, 2.0]}}, {"a": {"b": [1.0, 2.0], "c": 3}})
    for given in ({"a": {"b": [1, 2.5]}}, {"a": {"b": [1]}}, {"a": {"d": 1}}):
        with pytest.raises(Changed):
            require_same_values(given, {"a": {"b": [1.0, 2.0]}})


def test_a_slow_input_would_be_noticed(script: ModuleType) -> None:
    from fuzzing.judgement import TooSlow, limited

    with pytest.raises(TooSlow), limited(0.05):
        while True:
            pass


def test_the_recorded_run_tried_ten_thousand_inputs_and_found_nothing() -> None:
    record = json.loads((ROOT / "benchmarks/results/fuzz_inputs.json").read_text("utf-8"))
    assert record["inputs"] >= 10_000
    assert set(record["totals"]) == {"accepted", "refused"}
    assert sum(record["totals"].values()) == record["inputs"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = " + "[" * 5000 + "]" * 5000, "nested too deeply|TOML syntax error"),
        ("a = " + "9" * 5000, "a number or date that can't be read"),
        ("a = 1979-02-31", "can't be read|TOML syntax error"),
    ],
    ids=["deep", "long", "date"],
)
def test_text_that_python_can_not_read_is_one_clear_error(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        read_toml(path)


def test_a_device_is_no_case_file() -> None:
    with pytest.raises(InputError, match="/dev/zero: not a file"):
        read_toml(Path("/dev/zero"))


def test_messages_are_one_short_line_that_steers_no_terminal() -> None:
    (line,) = str(InputError(["given 'a\nb\x1b[31m\u202e" + "x" * 10_000])).splitlines()
    assert line.isprintable() and len(line) < LONGEST_LINE + 50
    assert r"\n" in line and r"\x1b" in line and r"\u202e" in line


@pytest.mark.parametrize("name", ["x" * 5000, "a\x00b", "x" * 300 + "/y"], ids=["long", "nul", "below"])
def test_a_directory_that_cannot_be_is_one_clear_error(tmp_path: Path, name: str) -> None:
    for resume in (False, True):
        with pytest.raises(OutputError, match="can't be written|no run to resume"):
            prepare_directory(tmp_path / name, resume=resume, overwrite=False)


@pytest.mark.parametrize("material", ["x" * 5000, "a\\u0000b", "/dev/zero", "/proc/self/mem", "../.."])
def test_a_material_that_is_no_file_is_one_clear_error(
    tmp_path: Path, material: str, capsys: pytest.CaptureFixture[str]
) -> None:
    case = (ROOT / "demos/aisi4340_demo/case.toml").read_text("utf-8").replace('"aisi4340"', f'"{material}"')
    (tmp_path / "case.toml").write_text(case)
    assert status(["check", str(tmp_path / "case.toml")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize(
    "name", ["../up", "/tmp/x", "..", ".", "a/b", "x" * 300, "ü" * 100, "a\\u0000", "<b>", "a b"]
)
def test_names_of_variants_never_become_other_paths(tmp_path: Path, name: str) -> None:
    sweep = tmp_path / "sweep.toml"
    sweep.write_text(f'case = "case.toml"\n[[variant]]\nname = "{name}"\ntool.rake = 1.0\n')
    with pytest.raises(InputError, match="name: given"):
        read_plan(sweep)


@pytest.mark.parametrize("value", ["../../up", "/etc/passwd", "a\x00b", "x" * 5000, "<script>", "..\\up"])
def test_values_of_variants_never_become_other_paths(value: str) -> None:
    from pfemcut.sweep.plan import variants_of

    (variant,) = variants_of({"workpiece.material": [value]}, {})
    assert Path(variant.name).name == variant.name and variant.name not in (".", "..")
    assert variant.name.isprintable() and len(variant.name.encode()) < 200


def test_a_path_of_a_thousand_keys_is_one_clear_error(capsys: pytest.CaptureFixture[str]) -> None:
    case = str(ROOT / "demos/aisi4340_demo/case.toml")
    assert status(["check", case, "--set", ".".join("a" * 2000) + "=1"]) == 2
    assert "tables deep" in capsys.readouterr().err


@pytest.mark.parametrize("spacing", [1e-6, 1e-30])
def test_solids_of_too_many_particles_are_one_clear_error(tmp_path: Path, spacing: float) -> None:
    """Before anything is filled; at 500 mm a box of 1 by 1e9 by 1 mm has two millions, and less than one across."""
    require_fillable("block", (1.0, 1e9, 1.0), 501.0)
    case = ROOT / "demos/taylor_tlsph/case.toml"
    assert status(["check", str(case), "--set", f"particles.spacing={spacing}"]) == 2
