"""Pressing of a block of particles: shear bands against the spacing."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from pfemcut.validation.study import Outcome, Study, Variant

MELTING = 1573.0
"""K; printed in Table 3 of Islam et al. 2019."""
SPACINGS = (0.02, 0.0133, 0.01, 0.00667)


def pressings(folder: Path, method: str) -> Study:
    """The study of the demo in ``folder``, whose case has this ``method``."""
    melting = f"body.0.material.hardening.melting_temperature={MELTING}"
    variants = tuple(
        Variant(f"spacing_{spacing:g}", (f"particles.spacing={spacing}", melting)) for spacing in SPACINGS
    )
    return Study(
        "bands", folder, variants, partial(_conclude, method), None, folder / "case.toml", partial=True
    )


def _conclude(method: str, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    raise NotImplementedError
