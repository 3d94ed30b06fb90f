"""The versions of dolfinx that pfemcut runs on: every call whose name or arguments changed lives here.

Written for dolfinx 0.5.2 (Debian 12).
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import cpp, jit
from dolfinx.mesh import GhostMode, create_mesh
from mpi4py import MPI
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

CELL = ufl.triangle


def coordinate_domain() -> ufl.Mesh:
    """A symbolic mesh of straight triangles; forms are written on it before any real mesh exists."""
    return ufl.Mesh(ufl.VectorElement("Lagrange", CELL, 1))


def nodal_element(components: int) -> Any:
    """Linear continuous element with ``components`` values a node."""
    if components == 1:
        return ufl.FiniteElement("Lagrange", CELL, 1)
    return ufl.VectorElement("Lagrange", CELL, 1, dim=components)


def cell_element(components: int) -> Any:
    """Element-wise constant element with ``components`` values a cell."""
    if components == 1:
        return ufl.FiniteElement("DG", CELL, 0)
    return ufl.VectorElement("DG", CELL, 0, dim=components)


def _compiled(comm: MPI.Comm, what: Any) -> tuple[Any, Any]:
    """Compiled form or element and its module, from the cache on disk if it was compiled before."""
    # The C compiler's command lines would otherwise appear among a user's progress lines.
    disabled = logging.root.manager.disable
    logging.disable(logging.INFO)
    try:
        compiled, module, _ = jit.ffcx_jit(comm, what, form_compiler_params={"scalar_type": "double"})
    finally:
        logging.disable(disabled)
    return compiled, module


class CompiledElement:
    """A finite element compiled once, from which spaces on any mesh are made without analysing it again."""

    def __init__(self, comm: MPI.Comm, element: Any):
        (self._element, self._dofmap), self._module = _compiled(comm, element)
        self._comm = comm

    def space(self, mesh: Any) -> Any:
        """The function space on the C++ ``mesh``."""
        ffi = self._module.ffi
        element = cpp.fem.FiniteElement(ffi.cast("uintptr_t", ffi.addressof(self._element)))
        dofmap = cpp.fem.create_dofmap(
            self._comm, ffi.cast("uintptr_t", ffi.addressof(self._dofmap)), mesh.topology, element
        )
        return cpp.fem.FunctionSpace(mesh, element, dofmap)


class CompiledForm:
    """A form compiled once and bound to every new mesh."""

    def __init__(self, comm: MPI.Comm, form: ufl.Form):
        self._compiled, self._module = _compiled(comm, form)
        positions = [
            self._compiled.original_coefficient_position[i] for i in range(self._compiled.num_coefficients)
        ]
        original = form.coefficients()
        self._coefficients = [original[i] for i in positions]
        self._constants = list(form.constants())

    def bind(
        self,
        mesh: Any,
        spaces: Sequence[Any],
        functions: dict[Any, Any],
        constants: dict[Any, Any],
    ) -> Any:
        """The form on the C++ ``mesh``, with real functions and constants for the symbols."""
        ffi = self._module.ffi
        subdomains = {
            kind: None
            for kind in (
                cpp.fem.IntegralType.cell,
                cpp.fem.IntegralType.exterior_facet,
                cpp.fem.IntegralType.interior_facet,
                cpp.fem.IntegralType.vertex,
            )
        }
        return cpp.fem.Form_float64(
            ffi.cast("uintptr_t", ffi.addressof(self._compiled)),
            list(spaces),
            [functions[c] for c in self._coefficients],
            [constants[c] for c in self._constants],
            subdomains,
            mesh,
        )


def new_mesh(comm: MPI.Comm, points: Array, cells: IntArray, domain: ufl.Mesh) -> Any:
    """A C++ mesh of all ``points`` and ``cells``, distributed over the ranks of ``comm``.

    Every rank holds all points and cells and hands in its share.
    """
    share = _share(comm, len(cells))
    nodes = _share(comm, len(points))
    mesh = create_mesh(
        comm,
        np.ascontiguousarray(cells[share], dtype=np.int64),
        np.ascontiguousarray(points[nodes]),
        domain,
        ghost_mode=GhostMode.none,
    )
    return mesh._mesh


def _share(comm: MPI.Comm, count: int) -> slice:
    return slice(count * comm.rank // comm.size, count * (comm.rank + 1) // comm.size)


def new_function(space: Any) -> Any:
    """A zero function in ``space``."""
    return cpp.fem.Function_float64(space)


def new_constant(value: float) -> Any:
    """A scalar constant."""
    return cpp.fem.Constant_float64(np.asarray(value, dtype=np.float64))


def new_matrix(form: Any) -> Any:
    """A PETSc matrix with the sparsity of the bilinear ``form``; the caller destroys it."""
    return cpp.fem.petsc.create_matrix(form)


def new_coupled_matrix(space: Any, groups: Iterable[NDArray[np.int32]]) -> Any:
    """A PETSc matrix on the ``space`` whose pattern also couples the local nodes of each of ``groups``."""
    mesh = space.mesh
    dofmap = space.dofmap
    pattern = cpp.fem.create_sparsity_pattern(mesh.topology, [dofmap, dofmap], {cpp.fem.IntegralType.cell})
    for group in groups:
        pattern.insert(group, group)
    pattern.assemble()
    return cpp.la.petsc.create_matrix(mesh.comm, pattern)


def assemble_matrix(matrix: Any, form: Any) -> None:
    """Add the bilinear ``form`` to ``matrix``, which the caller zeroes before and assembles after."""
    cpp.fem.petsc.assemble_matrix(
        matrix, form, cpp.fem.pack_constants(form), cpp.fem.pack_coefficients(form), []
    )


def assemble_vector(values: Array, form: Any) -> None:
    """Add the linear ``form`` to the local array ``values`` (owned and ghost entries)."""
    cpp.fem.assemble_vector(values, form, cpp.fem.pack_constants(form), cpp.fem.pack_coefficients(form))
