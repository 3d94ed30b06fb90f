"""``pfemcut new`` and ``pfemcut examples``: what they write passes ``pfemcut check``, also from an installed wheel."""

from __future__ import annotations

import os
import shutil
import site
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pfemcut.case.check import warnings
from pfemcut.case.load import load_case, validated
from pfemcut.case.schema import Case
from pfemcut.case.template import case_template
from pfemcut.cli.examples import example_names
from pfemcut.cli.main import status

ROOT = Path(__file__).parent.parent
DEMOS = sorted(path.parent.name for path in ROOT.glob("demos/*/case.toml"))


# pfemcut new


def test_a_new_case_passes_check_without_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my case.toml"
    options = ["--material", "ti6al4v_ducobu", "--rake", "6 deg", "--speed", "1000", "--depth", "60 um"]
    assert status(["new", str(path), *options]) == 0
    capsys.readouterr()
    assert status(["check", str(path)]) == 0
    said = capsys.readouterr().out
    assert "rake 6," in said and "1000 mm/s = 60 m/min" in said and "0.06 mm deep" in said
    assert "warning" not in said


def test_a_new_case_is_not_written_over_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.toml"
    path.write_text("mine", encoding="utf-8")
    assert status(["new", str(path)]) == 2
    assert "exists already, and is not overwritten" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--speed", "200 mm"], "[cutting] speed: given '200 mm', which is a length"),
        (["--speed", "0"], "[cutting] speed: given 0, must be greater than 0"),
        (["--rake", "80"], "[tool] rake: given 80, must be less than 45"),
        (["--material", "aisi434"], "unknown material 'aisi434'; did you mean 'aisi4340'?"),
        (["--depth", "nan"], "[cutting] depth: given nan, must be a finite number"),
    ],
)
def test_a_new_case_that_is_none_is_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], words: str
) -> None:
    path = tmp_path / "case.toml"
    assert status(["new", str(path), *options]) == 2
    assert words in capsys.readouterr().err
    assert not path.exists()


@settings(max_examples=50, deadline=2000)
@given(
    rake=st.floats(-44, 44).map(lambda angle: round(angle, 6)),
    tip_radius=st.floats(0.002, 0.2),
    speed=st.floats(1.0, 4e4),
    depths=st.floats(1.0, 50.0),
)
def test_any_new_cut_suits_the_rules_of_check(
    rake: float, tip_radius: float, speed: float, depths: float
) -> None:
    """From one to fifty tip radii deep, below which the tool ploughs; to 40 m/s, beyond which inertia is advised."""
    text = case_template("case.toml", "aisi4340", rake, tip_radius, speed, depths * tip_radius * 1.001)
    case, material = validated(tomllib.loads(text), ROOT)
    assert warnings(case, material) == []


def test_a_new_case_lists_every_key_and_its_default() -> None:
    """With every commented default uncommented the case is the same: the defaults are the schema's."""
    text = case_template("case.toml", "aisi4340", 0.0, 0.025, 3330.0, 0.1)
    optional = {"tool.conduction", "tool.body"}
    lines, table = [], ""
    for line in text.splitlines():
        bare = line[1:] if line.startswith("#") and not line.startswith("# ") else line
        if bare.startswith("["):
            table = bare.strip("[]")
        if table not in optional and not bare.endswith("= "):
            lines.append(bare)
    assert Case.model_validate(tomllib.loads("\n".join(lines))) == Case.model_validate(tomllib.loads(text))
    keys = [
        line.lstrip("#").split(" =")[0] for line in text.splitlines() if " =" in line and "# " not in line[:2]
    ]
    for model_key, field in Case.model_fields.items():
        model = field.annotation
        inner = getattr(model, "model_fields", {})
        assert all(key in keys or f"#[{model_key}.{key}]" in text for key in inner)


# pfemcut examples


def test_examples_are_the_demos(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["examples", "--list"]) == 0
    listed = capsys.readouterr().out
    assert [line.split()[0] for line in listed.splitlines()] == DEMOS == example_names()
    assert "AISI 4340, rigid tool, rake 6" in listed


@pytest.mark.parametrize("name", DEMOS)
def test_a_copied_example_is_the_demo_and_loads(name: str, tmp_path: Path) -> None:
    target = tmp_path / "mine"
    assert status(["examples", "--copy", name, str(target)]) == 0
    assert (target / "case.toml").read_bytes() == (ROOT / "demos" / name / "case.toml").read_bytes()
    load_case(target / "case.toml")


def test_examples_say_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["examples", "--copy", "aisi4340_demo", str(tmp_path)]) == 0
    assert status(["examples", "--copy", "aisi4340_demo", str(tmp_path)]) == 2
    assert "exists already, and is not overwritten" in capsys.readouterr().err
    assert status(["examples", "--copy", "aisi4340_dmo"]) == 2
    assert "did you mean 'aisi4340_demo'?" in capsys.readouterr().err
    assert status(["examples", str(tmp_path)]) == 2


# From an installed wheel


def test_examples_and_new_work_from_an_installed_wheel(tmp_path: Path) -> None:
    """A wheel built from a copy of the sources, installed apart from them, run in a folder without them."""
    source, installed = tmp_path / "source", tmp_path / "environment"
    source.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    for name in ("pfemcut", "meshing", "demos"):
        shutil.copytree(
            ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "out", "*.png")
        )
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    _run([*pip, "wheel", "--no-deps", "--no-build-isolation", "-w", str(tmp_path), str(source)], tmp_path)
    shutil.rmtree(source)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        packed = {name for name in archive.namelist() if name.startswith("pfemcut/examples/")}
    assert {f"pfemcut/examples/{name}/case.toml" for name in DEMOS} <= packed
    assert all(name.endswith(".toml") for name in packed)

    _run([sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", str(installed)], tmp_path)
    (packages,) = installed.glob("lib/python3*/site-packages")
    _run([*pip, "install", "--no-deps", "--target", str(packages), str(wheel)], tmp_path)
    # The dependencies are this environment's; its own pfemcut comes later on the path.
    (packages / "dependencies.pth").write_text("\n".join(site.getsitepackages()), encoding="utf-8")
    program = [str(installed / "bin" / "python"), "-m", "pfemcut"]
    where = _run([program[0], "-c", "import pfemcut; print(pfemcut.__file__)"], tmp_path)
    assert str(packages) in where
    assert [
        line.split()[0] for line in _run([*program, "examples", "--list"], tmp_path).splitlines()
    ] == DEMOS
    _run([*program, "examples", "--copy", "42cd4"], tmp_path)
    _run([*program, "check", "42cd4/case.toml"], tmp_path)
    _run([*program, "new", "--depth", "0.2 mm"], tmp_path)
    assert "0.2 mm deep" in _run([*program, "check", "case.toml"], tmp_path)


def _run(command: list[str], folder: Path) -> str:
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout
