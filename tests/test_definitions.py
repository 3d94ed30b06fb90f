"""The documentation of the figures says what the code says."""

from __future__ import annotations

import re
from pathlib import Path

from pfemcut.output.definitions import PICTURES, write_pictures
from pfemcut.results.definitions import FIGURES

DOCS = Path(__file__).parent.parent / "docs"


def test_every_figure_is_documented_with_its_unit_and_definition() -> None:
    text = (DOCS / "definitions.md").read_text(encoding="utf-8")
    for item in FIGURES:
        assert f"| `{item.name}` | {item.label} | {item.unit} | {item.meaning} |" in text


def test_every_picture_of_the_page_exists_and_is_drawn_by_the_code() -> None:
    shown = re.findall(r"\(pictures/(\w+)\.png\)", (DOCS / "definitions.md").read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(PICTURES)
    assert all((DOCS / "pictures" / f"{name}.png").exists() for name in shown)


def test_pictures_can_be_drawn_again(tmp_path: Path) -> None:
    write_pictures(tmp_path)
    assert {path.stem for path in tmp_path.iterdir()} == set(PICTURES)
