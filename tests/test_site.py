"""The documentation site: its navigation names every page, written pages are current, and the code on pages runs.

`make docs` builds it, which is left to a person or a server: it takes a minute, and packages that tests don't need.
"""

from __future__ import annotations

import importlib.util
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
import tomli_w

import meshing
import pfemcut
from pfemcut.cli.main import app, status

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"


def page(name: str) -> str:
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    """The code blocks of a page in a language."""
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# Navigation


def test_navigation_names_every_page_once() -> None:
    trees = re.findall(r"```\{toctree\}\n(.*?)```", page("index"), re.DOTALL)
    entries = [line for tree in trees for line in tree.splitlines() if line and not line.startswith(":")]
    named = [path for entry in entries for path in sorted(DOCS.glob(f"{entry}.md"))]
    assert len(named) == len(set(named))
    assert {path.resolve() for path in named} == {
        path.resolve()
        for path in (
            *(path for path in DOCS.glob("*.md") if path.stem != "index"),
            *DOCS.glob("api/*.md"),
            *ROOT.glob("demos/*/README.md"),
            *ROOT.glob("tests/verification/*/README.md"),
            ROOT / "CHANGELOG.md",
        )
    }
    assert all(list(DOCS.glob(f"{entry}.md")) for entry in entries)


def test_every_package_has_a_page_of_its_modules() -> None:
    pages = "".join(path.read_text(encoding="utf-8") for path in DOCS.glob("api/*.md"))
    documented = re.findall(r"modules-of:: (\S+)", pages)
    packages = [f"pfemcut.{each.name}" for each in pkgutil.iter_modules(pfemcut.__path__) if each.ispkg]
    assert sorted(documented) == sorted(["pfemcut", meshing.__name__, *packages])


# Written pages


def test_validation_page_is_up_to_date() -> None:
    assert page("validation") == script("validation_page").page(), "run python scripts/validation_page.py"


def test_validation_page_shows_computed_beside_measured() -> None:
    row = {
        "depth_mm": "0.06",
        "speed_m_min": "5",
        "cutting_force": "161.02",
        "cutting_force_uncertainty": "2.4367",
    }
    measured = {
        "cutting_force_measured": "138.7",
        "cutting_force_measured_scatter": "11.4",
        "cutting_force_difference": "0.16095",
    }
    made = script("validation_page")
    assert (
        made.prediction({**row, **measured}, ["cutting_force"])
        == "| 0.06 | 5 | 161 ± 2.4 | 139 ± 11 | +16 % |"
    )
    assert made.prediction(row, ["cutting_force"]) == "| 0.06 | 5 | 161 ± 2.4 |  |  |"


# Commands on pages


def test_first_cut_shows_what_check_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (command,) = re.findall(r"^    pfemcut new (.*)$", page("first_cut"), re.MULTILINE)
    words = [quoted or bare for quoted, bare in re.findall(r'"([^"]*)"|(\S+)', command)]
    assert status(["new", *words]) == 0
    capsys.readouterr()
    assert status(["check", "case.toml"]) == 0
    assert capsys.readouterr().out == blocks(page("first_cut"), "text")[0]


@pytest.mark.parametrize("name", ["units", "first_cut", "mpi_and_clusters", "install"])
def test_commands_on_pages_exist(name: str) -> None:
    lines = re.findall(r"(?:^    |`)(?:\S*/)?(?:mpirun -n \d )?pfemcut ([a-z]\w*)", page(name), re.MULTILINE)
    known = {info.name or info.callback.__name__ for info in app.registered_commands if info.callback}
    assert set(lines) <= known


# Laws on pages


@pytest.mark.parametrize(
    ("name", "folder", "law"),
    [
        ("adding_hardening_law", "pfemcut/materials/hardening", "cowper_symonds"),
        ("adding_friction_law", "pfemcut/contact/friction_laws", "decay"),
    ],
)
def test_a_law_added_as_the_page_says_works(name: str, folder: str, law: str, tmp_path: Path) -> None:
    """In a copy of the package: the file, the point test, and `pfemcut check` of a case with the law."""
    text = page(name)
    module, point_test = blocks(text, "python")
    (tables,) = blocks(text, "toml")
    assert f"In `{folder}`, the file `{law}.py`:" in text
    for package in ("pfemcut", "meshing"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / folder / f"{law}.py").write_text(module, encoding="utf-8")
    (tmp_path / "point_test.py").write_text(point_test, encoding="utf-8")
    case = tomllib.loads((ROOT / "demos" / "aisi4340_demo" / "case.toml").read_text(encoding="utf-8"))
    for section, values in tomllib.loads(tables).items():
        case[section] = {**case.get(section, {}), **values}
    (tmp_path / "case.toml").write_text(tomli_w.dumps(case), encoding="utf-8")

    run([sys.executable, "point_test.py"], tmp_path)
    said = run([sys.executable, "-m", "pfemcut", "check", "case.toml"], tmp_path)
    assert "AISI 4340" in said


def run(command: list[str], folder: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout
