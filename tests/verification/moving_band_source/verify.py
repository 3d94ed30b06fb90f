"""Convergence in the spacing and in the step, with the fine mesh following the source."""

from __future__ import annotations

from pathlib import Path

from .ladder import BAND, ladders

if __name__ == "__main__":
    ladders(Path(__file__).parent, BAND)
