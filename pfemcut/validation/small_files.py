"""Results made small enough to keep beside a demo: thinned histories, pictures below a size, tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pfemcut.output.tables import write_csv

ROWS = 400
PICTURE_BYTES = 150_000
_COLOURS = (256, 128, 64)
_SHRINK = 0.85


def write_thinned(path: Path, history: Mapping[str, NDArray[np.float64]], rows: int = ROWS) -> None:
    """Write at most ``rows`` rows, evenly spread and with the last, to six digits."""
    count = len(next(iter(history.values()), np.zeros(0)))
    chosen = np.unique(np.linspace(0, max(count - 1, 0), min(count, rows)).round().astype(int))
    write_csv(path, list(history), [[f"{column[i]:.6g}" for column in history.values()] for i in chosen])


def copy_picture(source: Path, target: Path, limit: int = PICTURE_BYTES) -> None:
    """Copy a PNG; one above ``limit`` bytes gets fewer colours, then fewer pixels, until it fits."""
    target.parent.mkdir(parents=True, exist_ok=True)
    data = source.read_bytes()
    if len(data) <= limit:
        target.write_bytes(data)
        return
    with Image.open(source) as opened:
        picture = opened.convert("RGB")
    while True:
        for colours in _COLOURS:
            picture.quantize(colours, dither=Image.Dither.NONE).save(target, format="PNG", optimize=True)
            if target.stat().st_size <= limit:
                return
        width, height = picture.size
        picture = picture.resize((int(width * _SHRINK), int(height * _SHRINK)), Image.Resampling.LANCZOS)
