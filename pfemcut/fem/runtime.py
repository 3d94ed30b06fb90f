"""The versions of dolfinx that pfemcut runs on: every call whose name or arguments changed lives here.

Written for dolfinx 0.5.2 (Debian 12), 0.9 (Debian 13) and 0.11 (a wheel). Forms are compiled once a run by dolfinx's
form compiler; what it made is called for every element of every mesh (:mod:`pfemcut.fem.element_kernels`).
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import ufl
from dolfinx import cpp, jit
from mpi4py import MPI

from pfemcut.inputs import UserError

TESTED = ("0.5", "0.9", "0.11")
"""Releases of dolfinx with which all tests pass."""


def _release(version: str) -> str:
    """The release that ``version`` is of, such as 0.11 for 0.11.0.post0."""
    return ".".join(version.split(".")[:2])


def require_tested(version: str) -> None:
    """Raise :class:`UserError` if no release of dolfinx that is known to work has this ``version``."""
    if _release(version) not in TESTED:
        raise UserError(
            f"dolfinx {version} is installed; pfemcut runs on {', '.join(TESTED[:-1])} and {TESTED[-1]} "
            "(docs/install.md says how to get one of them)"
        )


require_tested(cpp.__version__)

_OLD = _release(cpp.__version__) == "0.5"
if _OLD:
    _OPTIONS: dict[str, dict[str, Any]] = {"form_compiler_params": {"scalar_type": "double"}}
else:
    import basix.ufl

    _OPTIONS = {"form_compiler_options": {"scalar_type": np.float64}}


def _element(family: str, degree: int, shape: tuple[int, ...]) -> Any:
    """Element on triangles with values of a ``shape``: scalars or vectors."""
    if not _OLD:
        return basix.ufl.element(family, "triangle", degree, shape=shape)
    if shape == ():
        return ufl.FiniteElement(family, ufl.triangle, degree)
    return ufl.VectorElement(family, ufl.triangle, degree, dim=shape[0])


def _values(components: int) -> tuple[int, ...]:
    """Shape of values with so many ``components``: one is a scalar."""
    return () if components == 1 else (components,)


def coordinate_domain() -> ufl.Mesh:
    """A symbolic mesh of straight triangles; forms are written on it before any real mesh exists."""
    return ufl.Mesh(_element("Lagrange", 1, (2,)))


def nodal_element(components: int) -> Any:
    """Linear continuous element with ``components`` values a node."""
    return _element("Lagrange", 1, _values(components))


def cell_element(components: int) -> Any:
    """Element-wise constant element with ``components`` values a cell."""
    return _element("DG", 0, _values(components))


def _compiled(comm: MPI.Comm, what: Any) -> tuple[Any, Any]:
    """Compiled form and its module, from the cache on disk if it was compiled before."""
    # The C compiler's command lines would otherwise appear among a user's progress lines.
    disabled = logging.root.manager.disable
    logging.disable(logging.INFO)
    try:
        compiled, module, _ = jit.ffcx_jit(comm, what, **_OPTIONS)
    finally:
        logging.disable(disabled)
    return compiled, module


class CompiledForm:
    """A form with one integral over the cells, compiled once.

    Attributes
    ----------
    coefficients, constants
        Symbols of the form in the order in which the compiled function takes their values.
    address
        Of the compiled function.
    """

    def __init__(self, comm: MPI.Comm, form: ufl.Form):
        self._compiled, self._module = _compiled(comm, form)
        original = form.coefficients()
        self.coefficients = [original[i] for i in self._coefficient_positions()]
        self.constants = list(form.constants())
        integrals = self._cell_integrals()
        if len(integrals) != 1:
            raise ValueError("the form must have one integral over the cells")
        self.address = int(self._module.ffi.cast("intptr_t", integrals[0].tabulate_tensor_float64))

    def _coefficient_positions(self) -> list[int]:
        """Places of the compiled form's coefficients among those of the form as it was written."""
        compiled = self._compiled
        found = compiled.original_coefficient_position if _OLD else compiled.original_coefficient_positions
        return [found[i] for i in range(compiled.num_coefficients)]

    def _cell_integrals(self) -> list[Any]:
        compiled, cell = self._compiled, self._module.lib.cell
        if _OLD:
            found = compiled.integrals(cell)
            return [found[i] for i in range(compiled.num_integrals(cell))]
        first, end = compiled.form_integral_offsets[cell], compiled.form_integral_offsets[cell + 1]
        return [compiled.form_integrals[i] for i in range(first, end)]
