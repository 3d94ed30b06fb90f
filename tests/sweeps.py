"""Case and study files of short sweeps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w
from problems import SHORT_CUT

CASE: Mapping[str, Mapping[str, Any]] = {
    **SHORT_CUT,
    "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.008},
    "mesh": {
        "tip_size": 0.01,
        "shear_zone_size": 0.03,
        "chip_size": 0.03,
        "surface_size": 0.03,
        "far_size": 0.6,
        "growth": 0.3,
    },
    "time": {"step": 6e-8},
    "output": {"figures": False},
}
"""Forty steps of a very coarse cut."""


def written_case(folder: Path, **sections: Mapping[str, Any]) -> Path:
    path = folder / "case.toml"
    table = {name: {**CASE.get(name, {}), **sections.get(name, {})} for name in {**CASE, **sections}}
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def written_study(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path
