"""The return mapping and the volumetric law against closed forms, an ODE, finite differences and symmetries."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import REFERENCE_TEMPERATURE, Array, steel, voce
from scipy.integrate import solve_ivp

from pfemcut.materials.load import load_material
from pfemcut.materials.material import HardeningLaw
from pfemcut.materials.return_mapping import (
    Trial,
    deviatoric_energy,
    elastic_strain,
    elastic_trial,
    extrapolated_multiplier,
    implicit_multiplier,
    returned_deviator,
    tensor_norm,
)
from pfemcut.materials.volumetric import dilation, volume_ratio_from_pressure

MU = steel().shear_modulus
ROOT_2_3 = np.sqrt(2.0 / 3.0)
POINTS = 20
STEP = 1e-6
LAWS = {
    "perfect": voce(800.0),
    "linear": voce(800.0, linear=1500.0),
    "voce": load_material("voce_steel", None).hardening,
    "johnson-cook": load_material("aisi4340", None).hardening,
    "sima-ozel": load_material("ti6al4v_sima_ozel", None).hardening,
}
seeds = st.integers(0, 2**31)
laws = st.sampled_from(list(LAWS.values()))


def tensors(b: Array) -> Array:
    """Components (m, 4) as matrices (m, 3, 3)."""
    full = np.zeros((len(b), 3, 3))
    full[:, [0, 1, 2], [0, 1, 2]] = b[:, :3]
    full[:, 0, 1] = full[:, 1, 0] = b[:, 3]
    return full


def components(full: Array) -> Array:
    return np.column_stack([full[:, 0, 0], full[:, 1, 1], full[:, 2, 2], full[:, 0, 1]])


def padded(gradient: Array) -> Array:
    """Plane strain: f_33 = 1."""
    full = np.tile(np.eye(3), (len(gradient), 1, 1))
    full[:, :2, :2] = gradient
    return full


def random_gradient(rng: np.random.Generator, size: float) -> Array:
    return np.eye(2) + size * rng.normal(size=(POINTS, 2, 2))


def random_elastic(rng: np.random.Generator, size: float) -> Array:
    """Random isochoric b in the plane-strain form (m, 4)."""
    f = padded(random_gradient(rng, size))
    f[:, 2, 2] = np.exp(size * rng.normal(size=POINTS))
    b = f @ f.transpose(0, 2, 1)
    return components(b / np.linalg.det(b)[:, None, None] ** (1.0 / 3.0))


def state(seed: int, elastic: float = 0.003, motion: float = 0.01) -> tuple[Trial, Array, Array]:
    """A trial state with plastic strain and temperature."""
    rng = np.random.default_rng(seed)
    trial = elastic_trial(random_elastic(rng, elastic), random_gradient(rng, motion), MU)
    return trial, rng.uniform(0.0, 2.0, POINTS), rng.uniform(293.15, 1100.0, POINTS)


def yield_excess(law: HardeningLaw, trial: Trial, multiplier: Array, eqps: Array, theta: Array) -> Array:
    strain = ROOT_2_3 * multiplier
    flow = law.flow_stress(eqps + strain, strain / STEP, theta).value
    return tensor_norm(returned_deviator(trial, multiplier)) - ROOT_2_3 * flow


@given(seeds)
def test_trial_state_is_the_isochoric_push_forward(seed: int) -> None:
    rng = np.random.default_rng(seed)
    b, f = random_elastic(rng, 0.05), random_gradient(rng, 0.05)
    full = padded(f)
    pushed = np.linalg.det(full)[:, None, None] ** (-2.0 / 3.0) * full @ tensors(b) @ full.transpose(0, 2, 1)
    mean = np.trace(pushed, axis1=1, axis2=2) / 3.0
    trial = elastic_trial(b, f, MU)
    assert trial.jacobian == pytest.approx(np.linalg.det(f), rel=1e-13)
    assert trial.mu_bar == pytest.approx(MU * mean, rel=1e-13)
    expected = MU * (pushed - mean[:, None, None] * np.eye(3))
    assert np.allclose(tensors(trial.deviator), expected, rtol=0.0, atol=1e-12 * MU)
    assert trial.norm == pytest.approx(np.linalg.norm(expected, axis=(1, 2)), rel=1e-11)


@given(seeds, laws, st.floats(-2.0, 8.0))
def test_the_guess_changes_nothing(seed: int, law: HardeningLaw, exponent: float) -> None:
    """Multipliers from any rate to start with agree to 1e-9 of the one that would take all stress."""
    rng = np.random.default_rng(seed)
    trial = elastic_trial(random_elastic(rng, 0.05), random_gradient(rng, 0.05), MU)
    eqps, theta = rng.uniform(0.0, 1.0, len(trial.norm)), rng.uniform(300.0, 900.0, len(trial.norm))
    plain = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps)).value
    guess = rng.uniform(0.0, 10.0**exponent, len(eqps))
    found = implicit_multiplier(trial, law, eqps, theta, STEP, guess).value
    assert np.max(np.abs(found - plain) * 2.0 * trial.mu_bar / trial.norm) < 1e-9


@given(seeds, laws)
def test_returned_stress_lies_on_the_yield_surface(seed: int, law: HardeningLaw) -> None:
    trial, eqps, theta = state(seed)
    multiplier = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps)).value
    plastic = multiplier > 0.0
    assert plastic.any()
    assert (
        np.abs(yield_excess(law, trial, multiplier, eqps, theta)[plastic] / trial.norm[plastic]).max() < 1e-10
    )


@given(seeds, laws)
def test_inside_the_yield_surface_nothing_flows(seed: int, law: HardeningLaw) -> None:
    trial, eqps, theta = state(seed, motion=0.003)
    found = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps))
    elastic = trial.norm <= ROOT_2_3 * law.flow_stress(eqps, np.zeros(POINTS), theta).value
    for each in (found.value, found.by_norm, found.by_mu_bar):
        assert np.all((each == 0.0) == elastic)
    assert np.array_equal(returned_deviator(trial, found.value)[elastic], trial.deviator[elastic])


@given(seeds, st.floats(0.0005, 0.2))
def test_elastic_strain_has_unit_determinant_and_the_given_deviator(seed: int, size: float) -> None:
    """To 1e-12, from the strains of metals to a hundred times as much."""
    b = random_elastic(np.random.default_rng(seed), size)
    deviator = b.copy()
    deviator[:, :3] -= b[:, :3].mean(axis=1, keepdims=True)
    found = elastic_strain(MU * deviator, MU)
    assert np.linalg.det(tensors(found)) == pytest.approx(np.ones(POINTS), rel=1e-12)
    assert np.allclose(found, b, rtol=1e-10, atol=1e-10)


def shifted(trial: Trial, norm: float = 0.0, mu_bar: float = 0.0) -> Trial:
    return Trial(trial.jacobian, trial.deviator, trial.norm * (1.0 + norm), trial.mu_bar * (1.0 + mu_bar))


@given(seeds, laws)
def test_implicit_multiplier_has_its_derivatives(seed: int, law: HardeningLaw) -> None:
    """Central differences; 1e-5 of the derivative where both sides are plastic and above the reference rate."""
    trial, eqps, theta = state(seed)
    found = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps))
    h = 1e-6

    def value(**change: float) -> Array:
        return implicit_multiplier(
            shifted(trial, **change), law, eqps, theta, STEP, np.zeros_like(eqps)
        ).value

    smooth = found.value > 1e-5
    by_norm = (value(norm=h) - value(norm=-h)) / (2.0 * h * trial.norm)
    by_mu_bar = (value(mu_bar=h) - value(mu_bar=-h)) / (2.0 * h * trial.mu_bar)
    assert by_norm[smooth] == pytest.approx(found.by_norm[smooth], rel=1e-5)
    assert by_mu_bar[smooth] == pytest.approx(found.by_mu_bar[smooth], rel=1e-5)


@given(seeds, st.floats(0.0, 1e-2))
def test_extrapolated_multiplier_is_clamped_with_its_derivatives(seed: int, increment: float) -> None:
    """Rate times step, but never more than 0.9 of the trial stress; derivatives against differences."""
    trial, _, _ = state(seed)
    rate = increment / STEP * np.random.default_rng(seed + 1).random(POINTS)
    found = extrapolated_multiplier(trial, rate, STEP)
    limit = 0.9 * trial.norm / (2.0 * trial.mu_bar)
    assert found.value == pytest.approx(np.minimum(rate * STEP, limit), rel=1e-13)
    assert np.all(1.0 - 2.0 * trial.mu_bar * found.value / trial.norm >= 0.1 - 1e-12)
    away = np.abs(rate * STEP / limit - 1.0) > 1e-4
    h = 1e-6

    def value(**change: float) -> Array:
        return extrapolated_multiplier(shifted(trial, **change), rate, STEP).value

    by_norm = (value(norm=h) - value(norm=-h)) / (2.0 * h * trial.norm)
    by_mu_bar = (value(mu_bar=h) - value(mu_bar=-h)) / (2.0 * h * trial.mu_bar)
    assert np.allclose(by_norm[away], found.by_norm[away], rtol=1e-6, atol=1e-15)
    assert np.allclose(by_mu_bar[away], found.by_mu_bar[away], rtol=1e-6, atol=1e-15)


def test_both_sides_of_the_clamp_are_met() -> None:
    trial, _, _ = state(1)
    found = extrapolated_multiplier(trial, np.linspace(0.0, 2e4, POINTS), STEP)
    assert 0 < (found.by_norm > 0.0).sum() < POINTS


@given(seeds, laws, st.floats(0.0, 2.0 * np.pi))
def test_update_is_objective(seed: int, law: HardeningLaw, angle: float) -> None:
    """A superposed rotation rotates the updated b (1e-11) and leaves the multiplier (1e-9 relative)."""
    rng = np.random.default_rng(seed)
    b, f = random_elastic(rng, 0.003), random_gradient(rng, 0.01)
    eqps, theta = rng.uniform(0.0, 2.0, POINTS), rng.uniform(293.15, 1100.0, POINTS)
    q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def updated(gradient: Array) -> tuple[Array, Array]:
        trial = elastic_trial(b, gradient, MU)
        multiplier = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps)).value
        return elastic_strain(returned_deviator(trial, multiplier), MU), multiplier

    plain, multiplier = updated(f)
    rotated, same = updated(q @ f)
    full = padded(np.tile(q, (POINTS, 1, 1)))
    assert np.allclose(
        tensors(rotated), full @ tensors(plain) @ full.transpose(0, 2, 1), rtol=0.0, atol=1e-11
    )
    assert np.allclose(same, multiplier, rtol=1e-9, atol=1e-15)


def sheared(law: HardeningLaw, shear: float, steps: int) -> tuple[Array, Array]:
    """b (4,) and eqps (1,) after simple shear in equal steps."""
    b, eqps = np.array([[1.0, 1.0, 1.0, 0.0]]), np.zeros(1)
    theta = np.full(1, REFERENCE_TEMPERATURE)
    f = np.array([[[1.0, shear / steps], [0.0, 1.0]]])
    for _ in range(steps):
        trial = elastic_trial(b, f, MU)
        multiplier = implicit_multiplier(trial, law, eqps, theta, STEP, np.zeros_like(eqps)).value
        b = elastic_strain(returned_deviator(trial, multiplier), MU)
        eqps = eqps + ROOT_2_3 * multiplier
    return b[0], eqps


def test_elastic_simple_shear_has_its_closed_form() -> None:
    """b = F F^T: shear stress mu gamma and normal stress difference mu gamma², to round-off over 50 steps."""
    gamma = 0.8
    b, _ = sheared(voce(1e9), gamma, 50)
    assert b == pytest.approx([1.0 + gamma**2, 1.0, 1.0, gamma], rel=1e-11)
    energy = deviatoric_energy(b[None], MU)
    assert energy == pytest.approx([0.5 * MU * gamma**2], rel=1e-10)


def exact_shear(yield_stress: float, hardening: float, shear: float) -> tuple[Array, float]:
    """Rate equations of the same law: dev(b)' = dev(l b + b l^T) - 2 g' tr(b)/3 n with det b = 1 (scipy, 1e-11)."""
    l_gradient = np.zeros((3, 3))
    l_gradient[0, 1] = 1.0

    def b_of(deviator: Array) -> Array:
        return tensors(elastic_strain(MU * deviator[None], MU))[0]

    def rates(_: float, y: Array) -> Array:
        b = b_of(y[:4])
        stretch = l_gradient @ b + b @ l_gradient.T
        stretch -= np.trace(stretch) / 3.0 * np.eye(3)
        deviator = tensors(y[None, :4])[0]
        n = deviator / np.linalg.norm(deviator)
        mean = np.trace(b) / 3.0
        flow = MU * np.sum(n * stretch) / (2.0 * MU * mean + 2.0 / 3.0 * hardening)
        change = stretch - 2.0 * flow * mean * n
        return np.r_[components(change[None])[0], ROOT_2_3 * flow]

    # Elastic until |dev(F F^T)|² mu² = 2/3 sigma_y², that is 2/3 gamma^4 + 2 gamma² = 2/3 (sigma_y / mu)².
    square = 0.5 * (-3.0 + np.sqrt(9.0 + 4.0 * (yield_stress / MU) ** 2))
    first = np.sqrt(square)
    start = np.array([2.0 / 3.0 * square, -square / 3.0, -square / 3.0, first, 0.0])
    solution = solve_ivp(rates, (first, shear), start, rtol=1e-11, atol=1e-13, method="DOP853")
    y = solution.y[:, -1]
    return components(b_of(y[:4])[None])[0], float(y[4])


@pytest.mark.parametrize("hardening", [0.0, 1500.0])
def test_plastic_simple_shear_converges_to_the_rate_equations(hardening: float) -> None:
    """At shear 0.5 in 400 steps: b - 1 and eqps within 0.1 %, and half the error with twice the steps."""
    law = voce(800.0, linear=hardening)
    b, eqps = exact_shear(800.0, hardening, 0.5)
    errors = []
    for steps in (200, 400):
        found, strain = sheared(law, 0.5, steps)
        errors.append(
            np.array([np.abs(found - b).max() / np.abs(b - [1, 1, 1, 0]).max(), abs(strain[0] / eqps - 1.0)])
        )
    assert errors[1].max() < 1e-3
    assert np.all(errors[1] < 0.6 * errors[0] + 1e-9)


def test_perfectly_plastic_shear_stays_on_its_yield_surface() -> None:
    """|s| = sqrt(2/3) sigma_y, shear stress near sigma_y / sqrt(3), eqps near gamma / sqrt(3)."""
    yield_stress, gamma = 800.0, 2.0
    b, eqps = sheared(voce(yield_stress), gamma, 500)
    stress = MU * (b - np.r_[np.full(3, b[:3].mean()), 0.0])
    assert tensor_norm(stress[None]) == pytest.approx([ROOT_2_3 * yield_stress], rel=1e-10)
    assert stress[3] == pytest.approx(yield_stress / np.sqrt(3.0), rel=1e-4)
    elastic = yield_stress / MU / np.sqrt(3.0)
    assert eqps[0] == pytest.approx((gamma - elastic) / np.sqrt(3.0), rel=2e-3)


def test_rate_enters_through_the_step() -> None:
    """Johnson-Cook: a hundred times faster adds C ln 100 to the rate factor at equal strain."""
    law = LAWS["johnson-cook"]
    trial, _, _ = state(4)
    eqps, theta = np.full(POINTS, 5.0), np.full(POINTS, REFERENCE_TEMPERATURE)
    slow = implicit_multiplier(trial, law, eqps, theta, 1e-3, np.zeros_like(eqps)).value
    fast = implicit_multiplier(trial, law, eqps, theta, 1e-5, np.zeros_like(eqps)).value
    plastic = slow > 0.0
    stress = [tensor_norm(returned_deviator(trial, each))[plastic] for each in (slow, fast)]
    rates = [1.0 + 0.014 * np.log(ROOT_2_3 * each[plastic] / dt) for each, dt in ((slow, 1e-3), (fast, 1e-5))]
    assert np.all(fast[plastic] < slow[plastic])
    assert stress[1] / stress[0] == pytest.approx(rates[1] / rates[0], rel=1e-3)


@given(st.floats(0.8, 1.25), st.floats(-0.01, 0.05))
def test_volume_ratio_is_the_inverse_of_the_dilation(ratio: float, strain: float) -> None:
    """To 1e-13, far beyond what metal reaches."""
    pressure = dilation(np.array([ratio]), np.array([strain]))
    assert volume_ratio_from_pressure(pressure, np.array([strain])) == pytest.approx([ratio], rel=1e-13)


@given(st.floats(-0.05, 0.05), st.floats(0.0, 0.03))
def test_dilation_is_the_derivative_of_the_stored_energy(log: float, strain: float) -> None:
    """p / kappa = d/dJ (ln²J / 2 - e ln J / J), by central differences to 1e-8."""
    ratio, h = np.exp(log), 1e-6

    def energy(j: float) -> float:
        return 0.5 * np.log(j) ** 2 - strain * np.log(j) / j

    slope = (energy(ratio + h) - energy(ratio - h)) / (2.0 * h)
    assert dilation(np.array([ratio]), np.array([strain]))[0] == pytest.approx(slope, abs=1e-8)


def test_free_thermal_expansion_is_three_alpha() -> None:
    """p = 0 gives ln J / (1 - ln J) = e / J: J - 1 = 3 alpha dtheta to first order."""
    strain = np.array([1e-5, 9e-3])
    ratio = volume_ratio_from_pressure(np.zeros(2), strain)
    assert ratio[0] - 1.0 == pytest.approx(1e-5, rel=1e-4)
    log = np.log(ratio)
    assert ratio * log / (1.0 - log) == pytest.approx(strain, rel=1e-11)
