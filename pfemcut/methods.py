"""From a problem to the method that runs it."""

from __future__ import annotations

from pfemcut.driver import AnyProblem, MethodFactory
from pfemcut.particles.problem import ParticleProblem


def factory_of(problem: AnyProblem) -> MethodFactory:
    """What makes the method of ``problem``; only its own packages are loaded."""
    if isinstance(problem, ParticleProblem):
        from pfemcut.particles.method import ParticleMethod
        from pfemcut.sph.tlsph import TotalLagrangian

        model = TotalLagrangian(problem)
        return MethodFactory(
            start=lambda: ParticleMethod.start(model),
            restore=lambda state: ParticleMethod.restore(model, state),
        )
    from pfemcut.pfem.method import PfemMethod

    meshed = problem
    return MethodFactory(
        start=lambda: PfemMethod.start(meshed), restore=lambda state: PfemMethod.restore(meshed, state)
    )
