"""The shear modulus that scales the pressure projection."""

from __future__ import annotations

import numpy as np
import pytest

from pfemcut.materials.return_mapping import elastic_strain
from pfemcut.pfem.stabilisation import modulus_ratio
from pfemcut.problem import StabilisationModulus

MU, SIGMA = 80e3, 600.0
TENSION = SIGMA * np.array([[2.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0, 0.0]])
SHEAR = SIGMA * np.array([[0.0, 0.0, 0.0, 1.0 / np.sqrt(3.0)]])


@pytest.mark.parametrize("deviator", [TENSION, SHEAR], ids=["tension", "shear"])
def test_secant_modulus_of_a_flowing_element(deviator: np.ndarray) -> None:
    """sigma / (sigma + 3 mu eqps) to 1e-12, whatever the direction of the stress, and no less than 0.1."""
    eqps = np.array([1e-3, 5e-3, 0.02, 3.0])
    b = np.repeat(elastic_strain(deviator, MU), len(eqps), axis=0)
    found = modulus_ratio(StabilisationModulus.SECANT, b, eqps, np.ones_like(eqps))
    assert found == pytest.approx(np.maximum(SIGMA / (SIGMA + 3.0 * MU * eqps), 0.1), rel=1e-12)


def test_elastic_where_nothing_flows() -> None:
    """Unloaded, unstressed and elastic elements, and the elastic rule anywhere, have the material's modulus."""
    b = np.vstack([elastic_strain(TENSION, MU), [[1.0, 1.0, 1.0, 0.0]], elastic_strain(TENSION, MU)])
    eqps = np.array([0.5, 0.5, 0.0])
    unloaded = modulus_ratio(StabilisationModulus.SECANT, b, eqps, np.array([0.0, 0.0, 1.0]))
    assert np.all(unloaded == 1.0)
    assert np.all(modulus_ratio(StabilisationModulus.ELASTIC, b, eqps, np.ones(3)) == 1.0)
