"""Element matrices and vectors by the functions that the form compiler made, added up without a finite-element mesh.

A linear triangle needs nothing of a mesh but its particles: the compiled function of a form takes the values of its
coefficients, the constants and the coordinates of one element. Here loops over the elements call it by its address,
and put the result straight into a vector or into the values of a sparse matrix (:mod:`pfemcut.fem.sparsity`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from pfemcut.fem import runtime

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class ElementKernel:
    """The compiled functions of the parts of a form, which are added.

    Attributes
    ----------
    parts
        The parts, which keep the functions alive.
    addresses
        Where the functions are; shape (p,).
    columns
        Columns of the packed element data (:class:`Packing`) in the order in which each function takes them, -1 after
        the last; shape (p, width).
    """

    parts: tuple[runtime.CompiledForm, ...]
    addresses: IntArray
    columns: IntArray

    def constants(self, values: dict[Any, float]) -> Array:
        """The ``values`` of the symbolic constants as each function takes them; shape (p, most)."""
        rows = [[values[symbol] for symbol in part.constants] for part in self.parts]
        table = np.zeros((len(rows), max(1, *map(len, rows)) if rows else 1))
        for row, taken in zip(table, rows, strict=True):
            row[: len(taken)] = taken
        return table


class Packing:
    """Where each coefficient of the forms lies in the packed data of an element, one row an element.

    A coefficient on particles has the values of the three corners, each with its components; one on elements its
    components.

    Parameters
    ----------
    widths
        Number of values that each coefficient has in an element, in the order of their places.
    """

    def __init__(self, widths: dict[Any, int]):
        ends = np.cumsum(list(widths.values()))
        self.width = int(ends[-1])
        self._columns = {
            symbol: np.arange(end - width, end, dtype=np.int64)
            for (symbol, width), end in zip(widths.items(), ends, strict=True)
        }

    def kernel(self, parts: Sequence[runtime.CompiledForm]) -> ElementKernel:
        """The functions of a form's ``parts``, whose coefficients are all packed here."""
        columns = np.full((len(parts), self.width), -1, dtype=np.int64)
        for row, part in zip(columns, parts, strict=True):
            taken = [column for symbol in part.coefficients for column in self._columns[symbol]]
            row[: len(taken)] = taken
        return ElementKernel(tuple(parts), np.array([part.address for part in parts]), columns)

    def columns(self, symbol: Any) -> slice:
        """Columns of the coefficient ``symbol``."""
        found = self._columns[symbol]
        return slice(int(found[0]), int(found[-1]) + 1)


@intrinsic
def _call(typing_context, address, tensor, coefficients, constants, coordinates, entity, permutation, custom):  # type: ignore[no-untyped-def]
    """Call the C function at ``address`` with the addresses of its arguments (UFC's ``tabulate_tensor``).

    The seventh, ``custom``, is new in ffcx 0.10. A function of an older one never looks at it: where arguments beyond
    its own lie is the caller's to clear away, on x86-64 and on 64-bit ARM.
    """
    signature = types.void(*[types.intp] * 8)

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        pointer = ir.IntType(8).as_pointer()
        function = builder.inttoptr(arguments[0], ir.FunctionType(ir.VoidType(), [pointer] * 7).as_pointer())
        builder.call(function, [builder.inttoptr(each, pointer) for each in arguments[1:]])
        return context.get_dummy_value()

    return signature, generate


@njit(cache=True)
def _tabulate(tensor, scratch, unused, addresses, columns, data, constants, coordinates):  # type: ignore[no-untyped-def]
    """Put the sum of the functions' tensors for one element into ``tensor``; ``scratch`` holds coefficients."""
    tensor[:] = 0.0
    for part in range(len(addresses)):
        for k in range(columns.shape[1]):
            if columns[part, k] < 0:
                break
            scratch[k] = data[columns[part, k]]
        _call(
            addresses[part],
            tensor.ctypes.data,
            scratch.ctypes.data,
            constants[part].ctypes.data,
            coordinates.ctypes.data,
            unused.ctypes.data,
            unused.ctypes.data,
            unused.ctypes.data,
        )


@njit(cache=True)
def add_vector(addresses, columns, data, constants, coordinates, cells, components, total):  # type: ignore[no-untyped-def]
    """Add the element vectors of a linear form to ``total`` (n * components,).

    Parameters
    ----------
    addresses, columns, constants
        Of the form's :class:`ElementKernel`.
    data
        Packed coefficients; shape (m, width).
    coordinates
        Coordinates x, y, 0 of the corners; shape (m, 9).
    cells
        Rows of ``total`` / components of the corners; shape (m, 3).
    components
        Unknowns a particle.
    """
    scratch, unused = np.zeros(columns.shape[1]), np.zeros(1)
    vector = np.zeros(3 * components)
    for i in range(len(cells)):
        _tabulate(vector, scratch, unused, addresses, columns, data[i], constants, coordinates[i])
        for a in range(3):
            for j in range(components):
                total[components * cells[i, a] + j] += vector[components * a + j]


@njit(cache=True)
def add_matrix(  # type: ignore[no-untyped-def]
    addresses,
    columns,
    data,
    constants,
    coordinates,
    cells,
    components,
    symmetric,
    first,
    starts,
    places,
    values,
):
    """Add the element matrices of a bilinear form to the ``values`` of a sparse matrix, own rows only.

    Parameters
    ----------
    addresses, columns, data, constants, coordinates, cells, components
        See :func:`add_vector`; ``cells`` in the numbers of the matrix.
    symmetric
        Add the symmetric part of the element matrices only.
    first, starts, places
        Of the :class:`pfemcut.fem.sparsity.Sparsity`: first own number, start of the blocks of each own row (r + 1,),
        and block of each pair of corners, -1 outside of the own rows (m, 9).
    values
        Values of the matrix in rows of scalars; changed in place.
    """
    scratch, unused = np.zeros(columns.shape[1]), np.zeros(1)
    width = 3 * components
    matrix = np.zeros(width * width)
    for i in range(len(cells)):
        _tabulate(matrix, scratch, unused, addresses, columns, data[i], constants, coordinates[i])
        if symmetric:
            for j in range(width):
                for k in range(j):
                    mean = 0.5 * (matrix[width * j + k] + matrix[width * k + j])
                    matrix[width * j + k] = mean
                    matrix[width * k + j] = mean
        for a in range(3):
            row = cells[i, a] - first
            for b in range(3):
                block = places[i, 3 * a + b]
                if block < 0:
                    continue
                start, count = starts[row], starts[row + 1] - starts[row]
                for j in range(components):
                    at = components * (components * start + j * count + block - start)
                    entry = width * (components * a + j) + components * b
                    for k in range(components):
                        values[at + k] += matrix[entry + k]


@njit(cache=True)
def pack_corners(data, column, values, cells):  # type: ignore[no-untyped-def]
    """Put the ``values`` (n, c) of the corners of the ``cells`` (m, 3) into ``data`` from ``column`` on."""
    components = values.shape[1]
    for i in range(len(cells)):
        for a in range(3):
            for k in range(components):
                data[i, column + components * a + k] = values[cells[i, a], k]


def corner_coordinates(points: Array, cells: IntArray) -> Array:
    """Coordinates x, y, 0 of the corners of each cell; shape (m, 9)."""
    coordinates = np.zeros((len(cells), 3, 3))
    coordinates[:, :, :2] = points[cells]
    return coordinates.reshape(len(cells), 9)
