"""Tables of particles in their page: made from what was recorded, and up to date."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def module() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "particles_tables", ROOT / "scripts" / "particles_tables.py"
    )
    assert spec is not None and spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def test_the_page_is_up_to_date(module: ModuleType) -> None:
    text = (ROOT / "docs" / "particles.md").read_text(encoding="utf-8")
    assert module.filled(text, ROOT / "demos") == text, "run python scripts/particles_tables.py"


def test_the_table_follows_what_was_recorded(module: ModuleType, tmp_path: Path) -> None:
    """A changed figure shows, in per cent where it must; without a record that is said."""
    results = tmp_path / "taylor_esph" / "results"
    shutil.copytree(ROOT / "demos" / "taylor_esph" / "results", results)
    header, first, *rest = (results / "ladder.csv").read_text(encoding="utf-8").splitlines()
    cells = dict(zip(header.split(","), first.split(","), strict=True))
    changed = ",".join({**cells, "length": "12.345", "unevenness": "0.0123"}.values())
    (results / "ladder.csv").write_text("\n".join([header, changed, *rest]) + "\n", encoding="utf-8")
    table = module.studied(tmp_path, "taylor", "ladder", module.TAYLOR)
    line = next(line for line in table.splitlines() if cells["run"].replace("_", " ") in line)
    assert line.startswith("| esph |")
    assert "| 12.35 |" in line or "| 12.34 |" in line
    assert line.endswith("| 1.230 |")
    assert module.studied(tmp_path, "pressing", "bands", module.PRESSING) == module.NOTHING
    assert module.methods_beside(tmp_path) == module.NOTHING
