"""Stand-ins for the runs of a calibration, whose parameters are known."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from pfemcut.calibrate.confidence import Confidence, confidence_of
from pfemcut.calibrate.fit import Computed, Controls, Fit, fitted
from pfemcut.calibrate.parameters import Parameter

Array = np.ndarray
Model = Callable[[tuple[float, ...]], Array]

FRICTION = Parameter("contact.friction", 0.05, 0.9, 0.15)
STRENGTH = Parameter("workpiece.material.strength", 200.0, 900.0, 300.0)
UNCERTAINTY = np.array([4.0, 3.0, 4.0, 3.0, 0.4, 0.4])


def merchant(point: tuple[float, ...]) -> Array:
    """Forces per width and shear angle (degrees) of Merchant's shear plane, 0.1 mm deep, at two rake angles."""
    friction, strength = point
    angle = math.atan(friction)
    forces, planes = [], []
    for rake in (0.0, math.radians(10.0)):
        plane = math.pi / 4.0 - 0.5 * (angle - rake)
        resultant = strength * 0.1 / (math.sin(plane) * math.cos(plane + angle - rake))
        forces += [resultant * math.cos(angle - rake), resultant * math.sin(angle - rake)]
        planes.append(math.degrees(plane))
    return np.array([*forces, *planes])


class StandIn:
    """An evaluator that counts, with noise of the model's figures that depends on the point alone."""

    def __init__(self, model: Model, noise: Array | float = 0.0) -> None:
        self.model, self.noise = model, noise
        self.asked: list[tuple[float, ...]] = []

    def __call__(self, points: Sequence[tuple[float, ...]]) -> list[Computed]:
        self.asked += points
        found = []
        for point in points:
            values = self.model(point)
            rng = np.random.default_rng(abs(hash(point)) % 2**32)
            noise = np.broadcast_to(self.noise, values.shape)
            found.append(Computed(values + noise * rng.standard_normal(values.shape), np.array(noise)))
        return found


def calibrated(
    parameters: Sequence[Parameter],
    measured: Array,
    uncertainties: Array,
    model: Model,
    noise: Array | float = 0.0,
    controls: Controls | None = None,
    *,
    assumed: bool = False,
) -> tuple[Fit, Confidence, StandIn]:
    evaluate, controls = StandIn(model, noise), controls or Controls()
    fit = fitted(parameters, measured, uncertainties, evaluate, controls)
    known = confidence_of(fit, parameters, measured, uncertainties, controls.difference, assumed=assumed)
    return fit, known, evaluate
