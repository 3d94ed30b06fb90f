"""Figures as PNG files."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from pfemcut.whole_files import replacing

DOTS_PER_INCH = 130


def write_picture(path: Path, figure: Figure, dots_per_inch: int = DOTS_PER_INCH) -> None:
    """Write a figure, at once."""
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", dpi=dots_per_inch)
