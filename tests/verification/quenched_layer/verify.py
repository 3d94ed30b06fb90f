"""Heat, cool and release the layer, and compare its profiles with the exact ones."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import trapezoid

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Axis, Cooling, Problem, Release, fixed, relaxed
from pfemcut.results.derived.residual import (
    MachinedSurface,
    ResidualProfile,
    residual_profile,
)

from ..common import Array, save_picture, set_keys, write_results
from . import reference as exact

FOLDER = Path(__file__).parent
SIZES = (0.08, 0.04, 0.02, 0.01)
HEIGHT = 1.0
LONG = 4.0  # mm, of the layer whose walls let go: its ends are as far from the middle as two heights
STIFF = 100.0  # factor on E, with the expansion divided by it: small strain at the same stresses
COOLING_TIME = 2.0  # s, 55 time constants


@dataclass(frozen=True)
class Quench:
    """A layer after cooling, or after its walls have let go.

    Attributes
    ----------
    profile
        Below the surface, around the middle.
    heating
        Largest heating of each particle (K), and its height (mm); (n,).
    height
        Of each particle (mm); (n,).
    method
        The run.
    seconds
        Wall time.
    stiffness
        Factor on E.
    """

    profile: ResidualProfile
    heating: Array
    height: Array
    method: PfemMethod
    seconds: float
    stiffness: float

    @property
    def heating_at(self) -> Array:
        """Largest heating (K) at the depths of the profile, between the particles of the middle."""
        order = np.argsort(self.height)
        return np.interp(HEIGHT - self.profile.depth, self.height[order], self.heating[order])


def layer(size: float, stiffness: float = STIFF, length: float = 0.2, release: bool = False) -> Quench:
    """Run a layer of the given length (mm), with the finest spacing ``size`` (mm)."""
    problem = _problem(size, stiffness, length, release)
    started = time.perf_counter()
    method = PfemMethod.start(problem)
    mesh = method.current.mesh
    largest = np.zeros(len(mesh.points))
    while not method.finished:
        method.advance()
        np.maximum(largest, method.current.fields.temperature - problem.body.temperature, out=largest)
    height = mesh.points[:, 1]
    middle = 0.5 * length
    near = np.abs(mesh.points[:, 0] - middle) < max(0.5 * length if not release else 0.2, 2.0 * size)
    surface = MachinedSurface(middle - 0.05, middle + 0.05, HEIGHT, 0.1)
    return Quench(
        residual_profile(method.frame(), surface),
        largest[near],
        height[near],
        method,
        time.perf_counter() - started,
        stiffness,
    )


def _problem(size: float, stiffness: float, length: float, release: bool) -> Problem:
    table = read_toml(FOLDER / "case.toml")
    set_keys(
        table,
        {
            "body.0.outline": [[0.0, 0.0], [length, 0.0], [length, HEIGHT], [0.0, HEIGHT]],
            "mesh.refine.0.end": [length, HEIGHT],
            "mesh.refine.0.size": size,
            "mesh.size": 4.0 * size,
        },
    )
    material_table = table["body"][0]["material"]
    material_table["young_modulus"] *= stiffness
    material_table["expansion"] /= stiffness
    case, material = validated(table, FOLDER)
    problem = problem_of(case, material, FOLDER)
    stages: list[Cooling | Release] = [
        Cooling(problem.body.temperature, ("bottom",), ("surface",), 0.0, COOLING_TIME, 60)
    ]
    if release:
        corners = ((Axis.X, "fixed"), (Axis.Y, "fixed"), (Axis.Y, "side"))
        stages.append(Release(tuple(fixed("bottom", axis, corner) for axis, corner in corners)))
    return relaxed(replace(problem, title="Quenched layer"), tuple(stages))


def figures(found: Quench) -> dict[str, float]:
    """Differences from the exact profile, in percent of the yield stress, and what must vanish."""
    profile = found.profile
    stress = exact.residual_stress(found.heating_at)
    strain = exact.plastic_strain(found.heating_at)
    percent = 100.0 / exact.YIELD_STRESS
    return {
        "surface_xx": float(profile.mean["stress_xx"][0]),
        "xx_rms_%": percent * _rms(profile, profile.mean["stress_xx"] - stress),
        "zz_rms_%": percent * _rms(profile, profile.mean["stress_zz"] - stress),
        "xx_largest_%": percent * float(np.abs(profile.mean["stress_xx"] - stress).max()),
        "yy_largest_%": percent * float(np.abs(profile.mean["stress_yy"]).max()),
        "plastic_strain_largest_%": 100.0
        * float(np.abs(found.stiffness * profile.mean["plastic_strain"] - strain).max() / strain.max()),
        "force": profile.section_force,
        "exact_force": float(trapezoid(stress, profile.depth)),
        "warmest": float(profile.mean["temperature"].max()),
    }


def released_figures(before: Quench, after: Quench) -> dict[str, float]:
    """The same after the walls have let go, from the clamped run's exact profile."""
    profile = after.profile
    stress = exact.residual_stress(before.heating_at)
    xx, zz = exact.released(before.profile.depth, stress)
    percent = 100.0 / exact.YIELD_STRESS
    return {
        "surface_xx": float(profile.mean["stress_xx"][0]),
        "exact_surface_xx": float(xx[0]),
        "xx_rms_%": percent * _rms(profile, profile.mean["stress_xx"] - xx),
        "zz_rms_%": percent * _rms(profile, profile.mean["stress_zz"] - zz),
        "force": profile.section_force,
        "force_over_its_size_%": 100.0 * profile.section_force / profile.section_size,
        "reaction": float(np.abs(after.method.current.last_reactions[:, 0]).max()),
    }


def _rms(profile: ResidualProfile, error: Array) -> float:
    """Root mean square over the depth."""
    return float(np.sqrt(trapezoid(error**2, profile.depth) / profile.depth[-1]))


def main() -> None:
    rows, runs = [], {}
    for stiffness, sizes in ((STIFF, SIZES), (1.0, SIZES[1:3])):
        for size in sizes:
            found = runs[size, stiffness] = layer(size, stiffness)
            rows.append(
                {"size": size, "young_modulus": 210e3 * stiffness, **figures(found), "seconds": found.seconds}
            )
            print(rows[-1])
    clamped, free = runs[0.02, STIFF], layer(0.02, STIFF, LONG, release=True)
    let_go = released_figures(clamped, free)
    print(let_go)
    write_results(
        FOLDER,
        rows,
        {
            "yield_stress": exact.YIELD_STRESS,
            "finest": rows[len(SIZES) - 1],
            "finite_strain": rows[-1],
            "released": let_go,
        },
    )
    _draw(clamped, free)


def _draw(clamped: Quench, free: Quench) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    depth = clamped.profile.depth
    stress = exact.residual_stress(clamped.heating_at)
    xx, zz = exact.released(depth, stress)
    left.plot(depth, stress, "k-", lw=1, label="exact, walls hold")
    left.plot(depth, clamped.profile.mean["stress_xx"], "C0o", ms=3, label="xx, walls hold")
    left.plot(depth, clamped.profile.mean["stress_zz"], "C1+", ms=5, label="zz, walls hold")
    left.plot(depth, xx, "k--", lw=1, label="exact xx, walls let go")
    left.plot(free.profile.depth, free.profile.mean["stress_xx"], "C2o", ms=3, label="xx, walls let go")
    left.plot(depth, zz, "k:", lw=1, label="exact zz, walls let go")
    left.plot(free.profile.depth, free.profile.mean["stress_zz"], "C3+", ms=5, label="zz, walls let go")
    left.set(xlabel="depth (mm)", ylabel="residual stress (MPa)")
    left.legend(fontsize=7)
    right.plot(depth, exact.plastic_strain(clamped.heating_at), "k-", lw=1, label="exact")
    right.plot(
        depth, clamped.stiffness * clamped.profile.mean["plastic_strain"], "C0o", ms=3, label="h = 0.02 mm"
    )
    right.set(xlabel="depth (mm)", ylabel="equivalent plastic strain", xlim=(0.0, 0.4))
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)
    plt.close(figure)


if __name__ == "__main__":
    main()
