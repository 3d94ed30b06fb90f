"""Cuts by a block of particles: feeds, spacings and artificial pressure."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from pfemcut.validation.study import Outcome, Study, Variant

MELTING = 1573.0
"""K; printed in Table 3 of Islam et al. 2019."""
FEEDS = (0.3, 0.5)
REDUCED, FULL = 0.02, 0.01


def cuts(folder: Path, method: str) -> Study:
    """The study of the demo in ``folder``, whose case has this ``method``."""
    variants = [_variant(feed, REDUCED) for feed in FEEDS]
    if method == "esph":
        variants.append(_variant(0.3, REDUCED, "gamma_0", "particles.artificial_pressure=0.0"))
    else:
        literature = "body.0.material.hardening.melting_temperature=1793.0"
        variants.append(_variant(0.3, REDUCED, "melting_1793", literature))
        variants += [_variant(feed, FULL) for feed in FEEDS]
    return Study(
        "cuts", folder, tuple(variants), partial(_conclude, method), None, folder / "case.toml", partial=True
    )


def _variant(feed: float, spacing: float, name: str = "", *changes: str) -> Variant:
    low = 1.0 - feed
    return Variant(
        f"feed_{feed:g}_{spacing:g}" + (f"_{name}" if name else ""),
        (
            f"body.1.box=[[3.0, {low}], [3.5, {low + 1.0}]]",
            f"particles.spacing={spacing}",
            "time.end=3.0e-5",
            f"body.0.material.hardening.melting_temperature={MELTING}",
            *changes,
        ),
    )


def _conclude(method: str, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    raise NotImplementedError
