"""Convergence in the spacing and in the step, with the fine mesh following the source."""

from __future__ import annotations

import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parents[1]))

from verification.moving_band_source.ladder import BAND, ladders  # noqa: E402

if __name__ == "__main__":
    ladders(FOLDER, BAND)
