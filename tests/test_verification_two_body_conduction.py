"""Block and conducting tool in contact against two half spaces: coarse versions of the verification."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.two_body_conduction.reference import (
    friction_rise,
    heat,
    interface_temperature,
    jump,
)
from tests.verification.two_body_conduction.verify import B_BLOCK, B_TOOL, COLD, END, HOT, conducted


def test_perfect_contact() -> None:
    """Both surfaces at the temperature by the effusivities, to 0.5 % of the difference to the cold body."""
    history = conducted().history
    wanted = interface_temperature(HOT, COLD, B_BLOCK, B_TOOL) - COLD
    assert history["block"][-1] - COLD == pytest.approx(wanted, rel=5e-3)
    assert history["tool"][-1] - COLD == pytest.approx(wanted, rel=5e-3)
    assert abs(history["heat_error"][-1]) < 1e-9
    assert abs(history["tool_heat_error"][-1]) < 1e-9


def test_contact_resistance() -> None:
    """Jump and heat, to 0.5 %."""
    history = conducted(conductance=50.0).history
    end = np.array([END])
    gap = history["block"][-1] - history["tool"][-1]
    assert gap == pytest.approx(jump(end, HOT - COLD, 50.0, B_BLOCK, B_TOOL), rel=5e-3)
    assert history["heat_to_tool"][-1] == pytest.approx(
        heat(end, HOT - COLD, 50.0, B_BLOCK, B_TOOL), rel=5e-3
    )


def test_frictional_heat_is_shared_by_effusivity() -> None:
    """The interface's rise, to 2 % on this mesh, with all of the heat put into the block."""
    history = conducted(partition=1.0, slides=True).history
    wanted = friction_rise(np.array([END]), float(history["power"].mean()), B_BLOCK, B_TOOL)
    assert history["block"][-1] - COLD == pytest.approx(wanted, rel=0.02)
    assert abs(history["tool_heat_error"][-1]) < 1e-9
