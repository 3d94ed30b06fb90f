"""Fields of one instant as arrays, as meshes of meshio and PyVista, and as a plot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.inputs import UserError, nearest
from pfemcut.method import Frame, IntArray

if TYPE_CHECKING:
    import meshio
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

UNITS = {
    "displacement": "mm",
    "damage": "-",
    "fibre_damage": "-",
    "matrix_damage": "-",
    "velocity": "mm/s",
    "pressure": "MPa",
    "temperature": "K",
    "particle_id": "-",
    "equivalent_plastic_strain": "-",
    "equivalent_plastic_strain_rate": "1/s",
    "von_mises": "MPa",
    "cauchy_stress": "MPa",
    "plastic_power": "mW/mm³",
}
"""Unit of each field; stress components are xx, yy, zz, xy, and pressure is positive in tension."""


class Fields:
    """The fields of the workpiece at one instant; ``fields["temperature"]`` is an array that can't be written to.

    Parameters
    ----------
    frame
        What the method shows of the instant.
    """

    def __init__(self, frame: Frame) -> None:
        self.frame = frame

    @property
    def step(self) -> int:
        """Number of the step."""
        return self.frame.step

    @property
    def time(self) -> float:
        """Time (s)."""
        return self.frame.time

    @property
    def travel(self) -> float:
        """Travel of the tool since first contact (mm)."""
        return self.frame.travel

    @property
    def points(self) -> Array:
        """Particle positions (mm); shape (n, 2)."""
        return _locked(self.frame.points)

    @property
    def cells(self) -> IntArray:
        """Triangles as particle indices, counter-clockwise; shape (m, 3)."""
        return _locked(self.frame.cells)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the fields: those on particles, then those on elements."""
        return (*self.frame.point_fields, *self.frame.cell_fields)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a field on particles, shape (n,) or (n, 2), or on elements, shape (m,) or (m, 4)."""
        for fields in (self.frame.point_fields, self.frame.cell_fields):
            if name in fields:
                return _locked(np.asarray(fields[name]))
        raise UserError(f"unknown field '{name}'{nearest(name, self.names)}")

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def unit(self, name: str) -> str:
        """Unit of a field; ``-`` for a pure number."""
        return UNITS[name] if name in self else str(self[name])

    def at_particles(self, name: str) -> Array:
        """A scalar field on particles, shape (n,): of element fields the average weighted by area.

        Elements have one Gauss point and carry noise that no particle shows; the average is the better picture.
        """
        values = np.asarray(self[name], dtype=np.float64)
        if values.ndim > 1:
            raise UserError(
                f"'{name}' has {values.shape[1]} components: choose one, as fields['{name}'][:, 0]"
            )
        if name in self.frame.point_fields:
            return values
        corners = self.frame.points[self.frame.cells]
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.repeat(np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]), 3)
        particles, count = self.frame.cells.ravel(), len(self.frame.points)
        total = np.bincount(particles, area, count)
        return np.asarray(
            np.bincount(particles, area * np.repeat(values, 3), count) / np.maximum(total, 1e-300)
        )

    def to_meshio(self) -> meshio.Mesh:
        """Return the workpiece as a meshio mesh: points (n, 3) in mm, triangles, all fields; a copy."""
        from pfemcut.output.vtu import body_mesh

        return body_mesh(self.frame)

    def to_pyvista(self) -> Any:
        """Return the workpiece as a ``pyvista.UnstructuredGrid`` with all fields; a copy.

        Raises
        ------
        UserError
            If PyVista is not installed; nothing else needs it.
        """
        try:
            import pyvista
        except ImportError as error:
            raise UserError(f"to_pyvista needs the package pyvista ({error}): pip install pyvista") from None
        mesh = self.to_meshio()
        (block,) = mesh.cells
        kind = {"triangle": pyvista.CellType.TRIANGLE, "vertex": pyvista.CellType.VERTEX}[block.type]
        grid = pyvista.UnstructuredGrid({kind: np.asarray(block.data)}, np.array(mesh.points))
        for name, values in mesh.point_data.items():
            grid.point_data[name] = np.array(values)
        for name, (values,) in mesh.cell_data.items():
            grid.cell_data[name] = np.array(values)
        return grid

    def plot(self, name: str = "temperature", axes: Axes | None = None, *, margin: float = 1.0) -> Axes:
        """Draw a scalar field with the tool by matplotlib; the axes are returned.

        Parameters
        ----------
        name
            A scalar field.
        axes
            Where to draw; new ones unless given.
        margin
            Half width of the view round the tool's tip, in the largest extent of contact or ten tip radii; infinite
            shows the whole body.
        """
        import matplotlib.pyplot as plt
        from matplotlib.tri import Triangulation

        frame, values = self.frame, self.at_particles(name)
        if axes is None:
            axes = plt.subplots(layout="constrained")[1]
        for tool in frame.tool:
            axes.fill(
                *tool.outline(100.0 * tool.tip_radius).T, facecolor="0.75", edgecolor="black", zorder=0.5
            )
        triangles = Triangulation(frame.points[:, 0], frame.points[:, 1], frame.cells)
        shown = axes.tripcolor(triangles, values, shading="gouraud", cmap="inferno")
        for loop in frame.loops:
            axes.plot(*frame.points[np.append(loop, loop[0])].T, color="black", linewidth=0.6)
        reach = max(
            [float(frame.contact.arc_length.max(initial=0.0)), *(10.0 * t.tip_radius for t in frame.tool)]
        )
        low, high = frame.points.min(axis=0), frame.points.max(axis=0)
        for tool in frame.tool if np.isfinite(margin) else ():
            centre = np.asarray(tool.centre)
            low, high = np.maximum(low, centre - margin * reach), centre + margin * reach
            high = np.minimum(high, frame.points.max(axis=0) + 0.2 * reach)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x (mm)", ylabel="y (mm)")
        axes.set_aspect("equal")
        plt.colorbar(shown, ax=axes, label=f"{name.replace('_', ' ')} ({self.unit(name)})")
        axes.set_title(f"travel {self.travel:.4g} mm")
        return axes


def _locked(values: NDArray[Any]) -> NDArray[Any]:
    """A view that can't be written to: the arrays are those that the run goes on with."""
    view = values.view()
    view.flags.writeable = False
    return view
