"""Constant heat flux on a half space against the erfc solution: second order in the spacing, first in the step."""

from __future__ import annotations

import numpy as np

from tests.verification.common import orders
from tests.verification.heat_flux_half_space.reference import backward_euler, exact
from tests.verification.heat_flux_half_space.verify import (
    CONDUCTIVITY,
    DIFFUSIVITY,
    END,
    FLUX,
    depth,
    errors,
    heated,
)


def test_second_order_in_the_spacing() -> None:
    sizes, found = (0.02, 0.01), []
    for size in sizes:
        result = heated(size, 20)
        reference = backward_euler(depth(result), 20, END / 20, FLUX, CONDUCTIVITY, DIFFUSIVITY)
        found.append(errors(result, reference)[0])
    assert orders(sizes, found)[1] > 1.8
    assert found[1] < 0.0015 * 171.4  # of the surface's rise


def test_first_order_in_the_step() -> None:
    steps = (8, 16, 32)
    rises = [heated(0.01, count).temperature for count in steps]
    first, second = np.abs(rises[1] - rises[0]).max(), np.abs(rises[2] - rises[1]).max()
    assert 0.9 < np.log2(first / second) < 1.1


def test_surface_temperature() -> None:
    result = heated(0.01, 100)
    reference = exact(depth(result), END, FLUX, CONDUCTIVITY, DIFFUSIVITY)
    assert abs(errors(result, reference)[2]) < 0.01 * 171.4
