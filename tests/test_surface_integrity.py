"""Profiles below a machined surface and exit burrs, on fields and outlines that are known exactly."""

from __future__ import annotations

import numpy as np
import pytest
from problems import cut_problem

from meshing.boundary import Outline
from meshing.notches import close_notches
from meshing.triangulation import constrained_delaunay
from pfemcut.method import Array, ContactView, Frame
from pfemcut.output.surface import write_residual
from pfemcut.output.vtu import boundary_loops
from pfemcut.results.derived.burr import exit_burr
from pfemcut.results.derived.patch_recovery import recovered
from pfemcut.results.derived.residual import (
    MachinedSurface,
    last_above,
    machined_surface,
    residual_figures,
    residual_profile,
)
from pfemcut.results.history import read_table

HEIGHT, LENGTH = 0.5, 1.0
SURFACE = MachinedSurface(0.3, 0.7, HEIGHT, 0.1)


def frame_of(points: Array, edges: Array, stress_of: object = None) -> Frame:
    """A frame of the body inside ``edges`` with element stresses given by their centres."""
    cells = constrained_delaunay(points, edges)
    centre = points[cells].mean(axis=1)
    stress = np.zeros((len(cells), 4)) if stress_of is None else stress_of(centre)  # type: ignore[operator]
    none = np.zeros(0)
    return Frame(
        0,
        0.0,
        0.0,
        points,
        cells,
        boundary_loops(cells),
        {"temperature": 300.0 + points[:, 0]},
        {"cauchy_stress": stress, "equivalent_plastic_strain": np.maximum(centre[:, 1] - 0.3, 0.0)},
        (),
        ContactView(np.zeros(0, dtype=np.int64), none, none, none),
    )


def block(stress_of: object, seed: int = 0) -> Frame:
    """A rectangle with randomly placed particles."""
    rng = np.random.default_rng(seed)
    x, y = np.linspace(0.0, LENGTH, 41), np.linspace(0.0, HEIGHT, 21)
    border = np.vstack(
        [
            np.column_stack([x[:-1], 0.0 * x[:-1]]),
            np.column_stack([0.0 * y[:-1] + LENGTH, y[:-1]]),
            np.column_stack([x[:0:-1], 0.0 * x[1:] + HEIGHT]),
            np.column_stack([0.0 * y[1:], y[:0:-1]]),
        ]
    )
    grid = np.stack(np.meshgrid(x[1:-1], y[1:-1]), axis=-1).reshape(-1, 2)
    inside = grid + rng.uniform(-0.006, 0.006, grid.shape)
    edges = np.column_stack([np.arange(len(border)), np.roll(np.arange(len(border)), -1)])
    return frame_of(np.vstack([border, inside]), edges, stress_of)


def linear(centre: Array) -> Array:
    x, y = centre.T
    return np.column_stack([100.0 - 300.0 * (HEIGHT - y), 20.0 * y, 50.0 + 10.0 * x, 0.0 * x])


def test_recovery_is_exact_for_linear_fields_up_to_the_surface() -> None:
    frame = block(linear)
    found = recovered(frame, frame.cell_fields["cauchy_stress"])
    assert np.allclose(found, linear(frame.points), rtol=0.0, atol=1e-6)


def test_profile_of_a_linear_field_is_exact_with_its_spread() -> None:
    profile = residual_profile(block(linear), SURFACE)
    assert np.allclose(profile.mean["stress_xx"], 100.0 - 300.0 * profile.depth, atol=1e-6)
    assert np.allclose(profile.mean["stress_zz"], 55.0, atol=1e-6)
    assert np.allclose(profile.std["stress_xx"], 0.0, atol=1e-6)
    # 10 MPa/mm over a window of 0.4 mm: uniform between its ends.
    assert np.allclose(profile.std["stress_zz"], 4.0 / np.sqrt(12.0), rtol=1e-3)
    assert np.allclose(profile.mean["temperature"], 300.5, atol=1e-6)
    # int_0^H (100 - 300 d) dd; exact for element values by their centres, but at the ends of the window.
    assert profile.section_force == pytest.approx(12.5, rel=0.02)


def test_figures_name_extremes_and_depths() -> None:
    figures = residual_figures(residual_profile(block(linear), SURFACE))
    assert figures["residual_surface_xx"]["mean"] == pytest.approx(100.0, abs=1e-6)
    assert figures["residual_tension_depth"]["value"] == 0.0
    assert figures["residual_compression"]["value"] == pytest.approx(-50.0, abs=1e-6)
    assert figures["residual_compression_depth"]["value"] == pytest.approx(HEIGHT)
    # Plastic strain y - 0.3 above it: 0.01 at 0.19 below the surface.
    assert figures["deformed_depth"]["value"] == pytest.approx(0.19, abs=0.005)
    assert last_above(np.array([0.0, 1.0, 2.0]), np.array([3.0, 1.0, 0.0]), 0.5) == pytest.approx(1.5)
    assert last_above(np.array([0.0, 1.0]), np.array([0.0, 0.0]), 0.5) == 0.0


def test_the_table_reads_back(tmp_path) -> None:  # type: ignore[no-untyped-def]
    profile = residual_profile(block(linear), SURFACE)
    write_residual(tmp_path / "residual.csv", profile)
    table = read_table(tmp_path / "residual.csv")
    assert list(table)[:3] == ["depth", "stress_xx", "stress_xx_std"]
    assert np.allclose(table["stress_xx"], profile.mean["stress_xx"], atol=1e-3)


def test_the_window_lies_between_tool_and_entry() -> None:
    (surface,) = machined_surface(cut_problem(cutting={"travel": 0.7}))
    # Workpiece 1.2 mm, first contact with the tip circle's centre 0.025 mm outside.
    assert surface.begin == pytest.approx(1.225 - 0.7 + 0.2)
    assert surface.end == pytest.approx(1.0)
    assert surface.level == pytest.approx(0.5)
    assert machined_surface(cut_problem(cutting={"travel": 0.4})) == ()


BURR = [
    *[(0.5, 0.0), (0.5, 0.4), (0.0, 0.4), (-0.1, 0.4), (-0.12, 0.38), (-0.2, 0.39), (-0.25, 0.3)],
    *[(-0.25, 0.29), (-0.13, 0.2), (-0.12, 0.34), (-0.1, 0.3), (-0.005, 0.25), (-0.001, 0.2), (0.0, 0.0)],
]


def test_burr_of_an_outline_drawn_with_the_ruler() -> None:
    points = np.array(BURR)
    edges = np.column_stack([np.arange(len(points)), np.roll(np.arange(len(points)), -1)])
    (burr,) = exit_burr(frame_of(points, edges), 0.0)
    assert burr.overhang == pytest.approx(0.25)
    assert burr.height == pytest.approx(0.12, abs=0.002)
    assert burr.neck_thickness == pytest.approx(0.04, abs=0.005)
    assert 0.0 < burr.root < 0.06
    assert burr.root_thickness == pytest.approx(0.14, abs=0.012)
    assert exit_burr(frame_of(points + [0.3, 0.0], edges), 0.0) == ()


def notched(*notch: tuple[float, float]) -> Outline:
    """A square with a notch in its upper side, counter-clockwise."""
    points = np.array(
        [
            *[
                (0, 0),
                (2, 0),
                (4, 0),
                (6, 0),
                (8, 0),
                (10, 0),
                (10, 3),
                (10, 6),
                (10, 10),
                (8, 10),
                (6.5, 10),
            ],
            *notch,
            *[(3.5, 10), (2, 10), (0, 10), (0, 6), (0, 3)],
        ],
        dtype=np.float64,
    )
    return Outline(
        points, np.arange(len(points)), np.zeros(len(points), dtype=np.int64), np.array([0, len(points)])
    )


def closed(outline: Outline, locked: tuple[int, ...] = ()) -> Outline:
    held = np.zeros(len(outline.points), dtype=bool)
    held[list(locked)] = True
    return close_notches(outline, np.full(len(held), 0.3), held)


@pytest.mark.parametrize(
    ("notch", "fewer"),
    [
        (((5.05, 10.0), (5.0, 8.0), (4.95, 10.0)), 2),
        (((4.98, 10.0), (5.0, 8.0), (5.02, 10.0)), 2),  # the walls have crossed
        (((5.05, 10.0), (5.0, 8.0), (4.98, 9.6)), 1),  # one wall's edge is shorter
    ],
)
def test_a_notch_that_is_shut_closes_and_keeps_the_area(
    notch: tuple[tuple[float, float], ...], fewer: int
) -> None:
    before = notched(*notch)
    after = closed(before)
    assert len(before.points) - len(after.points) == fewer
    assert after.area == pytest.approx(before.area, rel=1e-14)
    assert np.count_nonzero(after.particles < 0) == 1
    assert after.starts.tolist() == [0, len(after.points)]


def test_open_notches_and_supports_stay() -> None:
    opened = notched((5.3, 10.0), (5.0, 8.0), (4.7, 10.0))
    assert closed(opened) is opened
    shut = notched((5.05, 10.0), (5.0, 8.0), (4.95, 10.0))
    assert closed(shut, locked=(12,)) is shut
