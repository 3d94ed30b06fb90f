"""Coulomb friction of a block on a flat rigid face: sliding, sticking, coasting to a stop."""

from __future__ import annotations

import pytest

from tests.verification.sliding_block.reference import creep_speed
from tests.verification.sliding_block.verify import (
    LAWS,
    LENGTH,
    LIMIT,
    MASS,
    PRESSURE,
    SPEED,
    STOP,
    V_REF,
    dragged,
    dragged_by_law,
    free,
    sliding,
    sliding_by_law,
    tractions,
)


def test_slides() -> None:
    history = sliding(0.2).history
    assert history["thrust_force"][-1] == pytest.approx(PRESSURE * LENGTH, rel=1e-6)
    assert history["cutting_force"][-1] == pytest.approx(LIMIT, rel=1e-6)
    half = len(history["time"]) // 2
    late = LIMIT * SPEED * (history["time"][-1] - history["time"][half])
    assert history["friction_work"][-1] - history["friction_work"][half] == pytest.approx(late, rel=2e-4)
    assert history["heat_generated"][-1] - history["heat_generated"][half] == pytest.approx(
        0.5 * late, rel=2e-4
    )


@pytest.mark.parametrize("ratio", [0.5, 0.9])
def test_sticks_but_for_the_regularisation(ratio: float) -> None:
    history = dragged(ratio, size=0.2).history
    speed = (history["block_ux"][-1] - history["block_ux"][-2]) / history["dt"][-1]
    assert history["cutting_force"][-1] == pytest.approx(ratio * LIMIT, rel=1e-3)
    assert speed == pytest.approx(creep_speed(ratio, V_REF), rel=5e-3)


@pytest.mark.parametrize("law", LAWS)
def test_slides_by_each_law(law: str) -> None:
    """Force by the law's formula, to 0.5 %: the moment of friction still tilts the pressure a little."""
    history = sliding_by_law(law).history
    assert history["thrust_force"][-1] == pytest.approx(PRESSURE * LENGTH, rel=1e-6)
    assert history["cutting_force"][-1] == pytest.approx(tractions()[law] * LENGTH, rel=5e-3)


def test_sticks_below_the_shear_limit() -> None:
    law = "sticking-sliding, m k"
    history = dragged_by_law(law, 0.9).history
    speed = (history["block_ux"][-1] - history["block_ux"][-2]) / history["dt"][-1]
    assert history["cutting_force"][-1] == pytest.approx(0.9 * tractions()[law] * LENGTH, rel=1e-3)
    assert speed == pytest.approx(creep_speed(0.9, V_REF), rel=5e-3)


def test_kinetic_energy_becomes_heat() -> None:
    # Backward Euler dissipates one part in the number of steps.
    history = free(SPEED, 0.0, 50, 1.3 * STOP, size=0.2).history
    assert abs(history["speed"][-1]) < 0.01 * SPEED  # the elastic block still shakes
    assert history["friction_work"][-1] == pytest.approx(0.5 * MASS * SPEED**2, rel=0.03)
