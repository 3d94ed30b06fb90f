"""Tables of predicted and measured cuts in the pages: made from what was recorded, and up to date."""

from __future__ import annotations

import importlib.util
import math
import shutil
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def module() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "predictions_tables", ROOT / "scripts" / "predictions_tables.py"
    )
    assert spec is not None and spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    # Its dataclass looks itself up there.
    sys.modules[spec.name] = found
    spec.loader.exec_module(found)
    return found


def test_pages_are_up_to_date(module: ModuleType) -> None:
    for page, text in module.pages(ROOT).items():
        assert page.read_text(encoding="utf-8") == text, "run python scripts/predictions_tables.py"


def test_tables_follow_what_was_recorded(module: ModuleType, tmp_path: Path) -> None:
    """A changed figure in a set's CSV shows in its page, and nothing but the tables changes."""
    name = next(name for name in module.SETS if (ROOT / "demos" / name / "results").is_dir())
    for folder in (f"demos/{name}/results",):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    for file in ("README.md", f"demos/{name}/README.md", f"demos/{name}/case.toml"):
        shutil.copy(ROOT / file, tmp_path / file)
    before = module.pages(tmp_path)
    table = tmp_path / "demos" / name / "results" / "predict.csv"
    head, first, *rest = table.read_text(encoding="utf-8").splitlines()
    cells = first.split(",")
    cells[head.split(",").index("thrust_force")] = "987.6"
    table.write_text("\n".join([head, ",".join(cells), *rest]) + "\n", encoding="utf-8")
    after = module.pages(tmp_path)
    page = tmp_path / "demos" / name / "README.md"
    changed = set(after[page].splitlines()) - set(before[page].splitlines())
    assert len(changed) == 1
    assert "987.6 ±" in changed.pop()


def test_friction_of_the_rake_face(module: ModuleType) -> None:
    """A force along the face's normal has none; one that leans by atan 0.3 from it has 0.3."""
    for rake in (0.0, 15.0):
        each = module.Recorded("x", rake, [], [], {})
        for friction in (0.0, 0.3):
            angle = math.atan(friction) - math.radians(rake)
            force = (math.cos(angle), math.sin(angle))
            assert module._friction(force, each) == pytest.approx(friction, abs=1e-12)


def test_runs_whose_chip_was_not_complete_are_marked(module: ModuleType) -> None:
    """By the table where it says so, else by the warnings that were recorded; a cut by its own table."""
    figures = {f"{name}_change": "0.1" for name in module.FIGURES} | {"max_temperature": "700"}
    short = "in 13% of the window the chip was too short for the whole chip thickness range"
    warned = {"b": [short], "d": [short], "e": [short.replace("13%", "0%")]}
    content = {"runs": {name: {"warnings": texts} for name, texts in warned.items()}}
    rows = [
        {**figures, "run": "a", "relative_to": "cut"},
        {**figures, "run": "b", "relative_to": "a"},
        {**figures, "run": "c", "relative_to": "b", "chip_complete": "no"},
        {**figures, "run": "d", "relative_to": "c", "chip_complete": "yes"},
        {**figures, "run": "e", "relative_to": "whole"},
    ]
    cuts = [{"cut": "cut", "chip_complete": "no"}, {"cut": "whole", "chip_complete": "yes"}]
    table = module.sensitivities(module.Recorded("x", 0.0, cuts, rows, content))
    names = [line.split("|")[1:3] for line in table.splitlines() if line.startswith("| `")]
    assert names == [
        [" `a` ", " `cut` * "],
        [" `b` * ", " `a` "],
        [" `c` * ", " `b` * "],
        [" `d` ", " `c` * "],
        [" `e` ", " `whole` "],
    ]
    assert table.endswith(f"\\* {module.SHORT_CHIP}")
    whole = module.Recorded("x", 0.0, cuts, rows[4:], content)
    assert module.SHORT_CHIP not in module.sensitivities(whole)
