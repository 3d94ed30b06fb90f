"""Our assembly against dolfinx's own on the same forms, and the shares of the ranks."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from dolfinx.mesh import create_mesh
from hypothesis import given, settings
from hypothesis import strategies as st
from mpi4py import MPI
from numpy.typing import NDArray
from problems import Array, dense_tangent, kernels, rectangle_mesh

from pfemcut.fem import runtime
from pfemcut.fem.momentum_system import MomentumSystem, NodalForces
from pfemcut.fem.partition import Partition, shares
from pfemcut.pfem.momentum import ELEMENT_COMPONENTS, MomentumSymbols, momentum_forms
from pfemcut.pfem.step import PHASES
from pfemcut.timing import Stopwatch

MESH = rectangle_mesh(size=0.3, jitter=0.2)
COUNT, ELEMENTS = len(MESH.points), len(MESH.cells)
MODULI = np.array([8e4, 1.6e5]) * np.random.default_rng(4).uniform(0.5, 2.0, (ELEMENTS, 2))
STABILISATION = 1.3


# What dolfinx calls otherwise in the versions that we run on.
function_space = fem.functionspace if hasattr(fem, "functionspace") else fem.FunctionSpace


def real_mesh(domain: ufl.Mesh) -> Any:
    """``MESH`` in dolfinx, whose order of arguments changed in 0.10."""
    given = [domain, MESH.points]
    if list(inspect.signature(create_mesh).parameters).index("x") == 2:
        given.reverse()
    return create_mesh(MPI.COMM_SELF, MESH.cells, *given)


def entries(dofmap: Any) -> NDArray[np.int32]:
    """The rows of a ``dofmap`` one after the other; it was an adjacency list before 0.7."""
    return np.asarray(getattr(dofmap, "array", dofmap)).ravel()


def dolfinx_assembly(values: Sequence[Array]) -> tuple[Array, Array]:
    """Residual (n * 3,) and tangent of the momentum forms on ``MESH`` by dolfinx, in the order of the particles."""
    domain = runtime.coordinate_domain()
    mesh = real_mesh(domain)
    particles = np.asarray(mesh.geometry.input_global_indices)
    cells = np.asarray(mesh.topology.original_cell_index)
    functions: list[Any] = []
    numbering = np.empty(0)
    symbols = MomentumSymbols.on(domain)
    coefficients = (
        symbols.unknown,
        symbols.thermal_strain,
        symbols.settled_pressure,
        symbols.element,
        symbols.moduli,
    )
    for symbol, value in zip(coefficients, (*values, MODULI), strict=True):
        space = function_space(mesh, symbol.ufl_element())
        function = fem.Function(space)
        functions.append(function)
        places = entries(space.dofmap.list)
        if symbol in (symbols.element, symbols.moduli):
            function.x.array.reshape(ELEMENTS, -1)[places] = value[cells]
            continue
        node = np.empty(COUNT, dtype=int)
        node[places] = particles[entries(mesh.geometry.dofmap)]
        function.x.array[:] = value[node].ravel()
        if symbol is symbols.unknown:
            numbering = (3 * node[:, None] + np.arange(3)).ravel()
    stabilisation = fem.Constant(mesh, STABILISATION)
    for count, named in enumerate(functions):  # as MomentumSymbols.on does, and why
        named._count = count
    stabilisation._count = 0
    residual, jacobian = momentum_forms(mesh.ufl_domain(), MomentumSymbols(*functions, stabilisation))
    vector, matrix = np.zeros(3 * COUNT), np.zeros((3 * COUNT, 3 * COUNT))
    for part in residual:
        vector[numbering] += fem.assemble_vector(fem.form(part)).array
    for part in jacobian:
        form = fem.form(part)
        found = create_matrix(form)
        assemble_matrix(found, form)
        found.assemble()
        matrix[np.ix_(numbering, numbering)] += found[:, :]
        found.destroy()
    return vector, matrix


def state() -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(5)
    unknown = np.column_stack([0.01 * rng.normal(size=(COUNT, 2)), 300.0 * rng.normal(size=COUNT)])
    element = np.abs(rng.normal(1.0, 0.01, size=(ELEMENTS, ELEMENT_COMPONENTS)))
    element[:, 3] -= 1.0
    element[:, 5:8] = 1e-6 * rng.uniform(size=(ELEMENTS, 3))
    element[:, 8:10] = 1e3 * rng.uniform(size=(ELEMENTS, 2))
    return unknown, 0.01 * rng.uniform(size=COUNT), 200.0 * rng.normal(size=COUNT), element


def momentum_system(
    fixed: NDArray[np.bool_], strain: Array, settled: Array, *, symmetric: bool
) -> MomentumSystem:
    return MomentumSystem(
        kernels().momentum,
        Partition(MPI.COMM_SELF, MESH.points, MESH.cells),
        MESH.points,
        fixed,
        MODULI,
        STABILISATION,
        strain,
        settled,
        symmetric=symmetric,
        watch=Stopwatch(PHASES),
    )


def test_residual_and_tangent_are_those_of_dolfinx() -> None:
    """To 1e-12 of their largest entries, with both parts of the forms."""
    unknown, strain, settled, element = values = state()
    vector, matrix = dolfinx_assembly(values)
    fixed = np.zeros((COUNT, 3), dtype=bool)
    with momentum_system(fixed, strain, settled, symmetric=False) as system:
        found = system.internal_residual(unknown, element)
        tangent = dense_tangent(system, COUNT, fixed)
    assert np.abs(found.ravel() - vector).max() < 1e-12 * np.abs(vector).max()
    assert np.abs(tangent - matrix).max() < 1e-10 * np.abs(matrix).max()


@pytest.mark.parametrize("coupled", [False, True])
def test_symmetric_tangent_is_the_symmetric_part(coupled: bool) -> None:
    """Fixed unknowns and nodal stiffness included, to 1e-12 of the largest entry."""
    unknown, strain, settled, element = state()
    fixed = np.zeros((COUNT, 3), dtype=bool)
    fixed[::7, 0] = True
    rng = np.random.default_rng(6)
    first, second = MESH.cells[3, 0], MESH.cells[3, 1]
    rows, columns = np.array([first, second]), np.array([second if coupled else first, second])
    nodal = NodalForces(rows, np.zeros((2, 2)), rows, columns, 1e5 * rng.normal(size=(2, 2, 2)))
    matrices = []
    for symmetric in (False, True):
        with momentum_system(fixed, strain, settled, symmetric=symmetric) as system:
            system.internal_residual(unknown, element)
            system.assemble(nodal)
            matrices.append(system.matrix()[:, :])
    whole, half = matrices
    assert np.abs(half - 0.5 * (whole + whole.T)).max() < 1e-12 * np.abs(whole).max()
    assert np.abs(half - half.T).max() < 1e-14 * np.abs(whole).max()


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 200), st.integers(1, 7), st.integers(0, 10))
def test_shares_are_equal_and_disjoint(count: int, parts: int, seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(count, 2))
    part = shares(points, parts)
    sizes = np.bincount(part, minlength=parts)
    assert sizes.sum() == count
    assert sizes.max() - sizes.min() <= parts.bit_length()


def test_sparsity_is_the_graph_of_the_mesh() -> None:
    sparsity = Partition(MPI.COMM_SELF, MESH.points, MESH.cells).sparsity
    coupled = np.zeros((COUNT, COUNT), dtype=bool)
    for cell in MESH.cells:
        coupled[np.ix_(cell, cell)] = True
    found = np.zeros_like(coupled)
    for row in range(COUNT):
        neighbours = sparsity.neighbours[sparsity.starts[row] : sparsity.starts[row + 1]]
        assert np.all(np.diff(neighbours) > 0)
        found[row, neighbours] = True
    assert np.array_equal(found, coupled)
    for cell, places in zip(MESH.cells, sparsity.places, strict=True):
        assert np.array_equal(sparsity.neighbours[places].reshape(3, 3), np.tile(cell, (3, 1)))
    with pytest.raises(ValueError, match="does not couple"):
        apart = np.argwhere(~coupled)[0]
        sparsity.blocks(apart[:1], apart[1:])
