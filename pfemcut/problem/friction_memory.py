"""Where the memory that a friction law has is not used."""

from __future__ import annotations

from pfemcut.problem.problem import Problem


def memory_warnings(problem: Problem) -> list[str]:
    """What to know of friction between bodies that deform, where it has no memory; one line a place in the case."""
    laws = [("[contact]" if problem.tool else "[[contact]]", pair.law) for pair in problem.pairs]
    laws += [("[contact.self]", rule.law) for rule in problem.self_contact]
    where = dict.fromkeys(name for name, law in laws if law.friction.sliding_memory > 0.0)
    return [
        f"{name} friction: its memory acts on a rigid tool only; between bodies that deform the coefficient follows "
        "the speed of the last step, which may swing if it falls with the speed"
        for name in where
    ]
