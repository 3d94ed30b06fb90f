"""Metal cutting with the particle finite element method.

For scripts and notebooks, see ``docs/python.md``::

    import pfemcut

    case = pfemcut.load_case("case.toml", {"cutting.travel": 0.1})
    results = pfemcut.run(case, "out/first")       # writes what the command line writes
    simulation = pfemcut.Simulation(case)          # step by step, in memory

Units are mm, tonne, s and K (so N, MPa, mJ), angles degrees. Importing this package is quick: dolfinx and the rest are
loaded by what needs them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pfemcut.fields import Fields as Fields
    from pfemcut.inputs import UserError as UserError
    from pfemcut.loaded_case import LoadedCase as LoadedCase
    from pfemcut.loaded_case import load_case as load_case
    from pfemcut.method import Measures as Measures
    from pfemcut.method import RunStopped as RunStopped
    from pfemcut.moment import Moment as Moment
    from pfemcut.simulation import Results as Results
    from pfemcut.simulation import Simulation as Simulation
    from pfemcut.simulation import run as run

_HOMES = {
    "load_case": "pfemcut.loaded_case",
    "LoadedCase": "pfemcut.loaded_case",
    "run": "pfemcut.simulation",
    "Simulation": "pfemcut.simulation",
    "Results": "pfemcut.simulation",
    "Moment": "pfemcut.moment",
    "Fields": "pfemcut.fields",
    "Measures": "pfemcut.method",
    "RunStopped": "pfemcut.method",
    "UserError": "pfemcut.inputs",
}
"""Modules of the names that users import from here."""

__all__ = [
    "Fields",
    "LoadedCase",
    "Measures",
    "Moment",
    "Results",
    "RunStopped",
    "Simulation",
    "UserError",
    "load_case",
    "run",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'pfemcut' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
