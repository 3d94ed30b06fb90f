"""A rigid frictionless wedge in a perfectly plastic half plane, against the slip-line field."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.wedge_indentation.reference import fan_angle, force
from tests.verification.wedge_indentation.verify import indented, measured


def test_slip_line_field_becomes_prandtls_for_a_flat_punch() -> None:
    assert fan_angle(np.radians(89.999)) == pytest.approx(np.pi / 2.0, abs=0.02)
    assert force(np.radians(45.0), 2.0, 1.0) == pytest.approx(2.0 * force(np.radians(45.0), 1.0, 1.0))


def test_coarse_indentation() -> None:
    # Three spacings deep; the mesh of 0.007 mm at 0.1 mm comes within 1.8 % (force and pressure).
    row = measured(indented(0.02, 60.0, steps=50, depth=0.06), 60.0)
    assert abs(row["force_difference"]) < 0.08
    assert abs(row["face_pressure_difference"]) < 0.06
    assert abs(row["energy_error"]) < 0.02
    assert abs(row["area_drift_mm2"]) < 1e-12
