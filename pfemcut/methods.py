"""From a problem to the method that runs it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pfemcut.any_problem import AnyProblem
from pfemcut.driver import MethodFactory
from pfemcut.particles.problem import Formulation, ParticleProblem
from pfemcut.peridynamics.problem import LaminaProblem

if TYPE_CHECKING:
    from pfemcut.particles.formulation import ForceModel
    from pfemcut.particles.state import Memory


def factory_of(problem: AnyProblem) -> MethodFactory:
    """What makes the method of ``problem``; only its own packages are loaded."""
    if isinstance(problem, ParticleProblem):
        from pfemcut.sph.esph import Eulerian
        from pfemcut.sph.tlsph import TotalLagrangian

        if problem.formulation is Formulation.EULERIAN:
            return _particles(Eulerian(problem))
        return _particles(TotalLagrangian(problem))
    if isinstance(problem, LaminaProblem):
        from pfemcut.peridynamics.method import LatticeMethod

        lamina = problem
        return MethodFactory(
            start=lambda: LatticeMethod.start(lamina),
            restore=lambda state: LatticeMethod.restore(lamina, state),
        )
    from pfemcut.pfem.method import PfemMethod

    meshed = problem
    return MethodFactory(
        start=lambda: PfemMethod.start(meshed), restore=lambda state: PfemMethod.restore(meshed, state)
    )


def _particles(model: ForceModel[Memory]) -> MethodFactory:
    from pfemcut.particles.method import ParticleMethod

    return MethodFactory(
        start=lambda: ParticleMethod.start(model), restore=lambda state: ParticleMethod.restore(model, state)
    )
