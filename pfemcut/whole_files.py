"""Files that are written at once: whoever reads one meanwhile, or after a crash, sees the old one or the new one."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A file beside ``path`` to write to, which takes its place at the end of the block, unless that fails."""
    temporary = path.with_name(path.name + ".tmp")
    yield temporary
    os.replace(temporary, path)


def write_text(path: Path, text: str) -> None:
    """Write a text file."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def finite(value: float) -> float | None:
    """``value`` for a JSON file, which has no nan."""
    return value if math.isfinite(value) else None


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file; JSON has no nan, so there may be none in ``content``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
