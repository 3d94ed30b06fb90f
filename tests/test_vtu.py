"""Fields for ParaView: valid at every moment, and complete enough to be read back."""

from __future__ import annotations

import xml.etree.ElementTree as Xml
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from synthetic_cut import filled_frame, outline_frame

from pfemcut.method import Block, Frame
from pfemcut.output.vtu import FieldsError, FieldWriter, boundary_loops, read_last_frame


@pytest.fixture(scope="module")
def frame() -> Frame:
    return filled_frame(6.0, 0.15, spacing=0.05)


def files(directory: Path) -> list[tuple[str, str]]:
    sets = Xml.parse(directory / "fields.pvd").getroot().iter("DataSet")
    return [(s.attrib["file"], s.attrib["part"]) for s in sets]


def test_a_frame_comes_back_bit_for_bit(tmp_path: Path, frame: Frame) -> None:
    FieldWriter(tmp_path).write(frame)
    back = read_last_frame(tmp_path)
    assert (back.step, back.time, back.travel, back.tool) == (
        frame.step,
        frame.time,
        frame.travel,
        frame.tool,
    )
    assert back.points.tobytes() == frame.points.tobytes()
    assert np.array_equal(back.cells, frame.cells)
    assert set(back.point_fields) == set(frame.point_fields)
    for name, values in frame.point_fields.items():
        assert np.array_equal(back.point_fields[name], values), name
    assert set(back.cell_fields) == set(frame.cell_fields)
    for name, values in frame.cell_fields.items():
        assert np.array_equal(back.cell_fields[name], values), name
    order = np.argsort(frame.contact.particles)
    assert np.array_equal(back.contact.particles, frame.contact.particles[order])
    assert np.array_equal(back.contact.pressure, frame.contact.pressure[order])
    assert np.allclose(back.contact.arc_length, frame.contact.arc_length[order], atol=1e-15)


def test_a_tool_with_a_mesh_comes_back_with_its_fields(tmp_path: Path, frame: Frame) -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    cells = np.array([[0, 1, 2], [1, 3, 2]])
    warm = np.array([300.0, 400.0, 500.0, 600.0])
    FieldWriter(tmp_path).write(replace(frame, tool_blocks=(Block(points, cells, {"temperature": warm}),)))
    back = read_last_frame(tmp_path)
    assert (back.tool, back.travel) == (frame.tool, frame.travel)
    (block,) = back.tool_blocks
    assert np.array_equal(block.points, points)
    assert np.array_equal(block.cells, cells)
    assert np.array_equal(block.point_fields["temperature"], warm)


def test_boundary_loops_keep_the_body_on_the_left() -> None:
    # A square ring: an outer loop counter-clockwise, an inner one clockwise.
    cells, points = ring()
    loops = boundary_loops(cells)
    areas = sorted(signed_area(points[loop]) for loop in loops)
    assert areas == pytest.approx([-1.0, 9.0])


def ring() -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    points = np.column_stack([x.ravel(), y.ravel()])
    squares = [(i, j) for j in range(3) for i in range(3) if (i, j) != (1, 1)]
    cells = []
    for i, j in squares:
        a = 4 * j + i
        cells += [[a, a + 1, a + 5], [a, a + 5, a + 4]]
    return np.array(cells), points


def signed_area(p: np.ndarray) -> float:
    q = np.roll(p, -1, axis=0)
    return 0.5 * float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


def test_paraview_gets_standard_names_and_the_body_and_tool_as_parts(tmp_path: Path, frame: Frame) -> None:
    FieldWriter(tmp_path).write(frame)
    assert [part for _, part in files(tmp_path)] == ["0", "1"]
    mesh = meshio.read(tmp_path / files(tmp_path)[0][0])
    assert mesh.point_data["velocity"].shape == (len(frame.points), 3)
    assert mesh.cell_data["cauchy_stress"][0].shape == (len(frame.cells), 6)
    assert (mesh.cell_data["body"][0] == 0).all()
    tool = meshio.read(tmp_path / files(tmp_path)[1][0])
    assert set(tool.cells_dict) == {"line"}
    assert (tool.cell_data["body"][0] == 1).all()


def test_collection_is_whole_after_every_frame(tmp_path: Path, frame: Frame) -> None:
    writer = FieldWriter(tmp_path)
    for step in (10, 20, 30):
        writer.write(replace(frame, step=step))
        assert len(files(tmp_path)) == 2 * step / 10
        assert all((tmp_path / name).exists() for name, _ in files(tmp_path))
    assert not list(tmp_path.rglob("*.tmp"))


def test_resume_keeps_the_frames_up_to_the_checkpoint(tmp_path: Path, frame: Frame) -> None:
    writer = FieldWriter(tmp_path)
    for step in (10, 20, 30):
        writer.write(replace(frame, step=step))
    FieldWriter(tmp_path, last_step=20).write(replace(frame, step=25))
    steps = [int(name[-12:-4]) for name, part in files(tmp_path) if part == "0"]
    assert steps == [10, 20, 25]
    assert sorted(path.name for path in (tmp_path / "fields").glob("frame*")) == [
        f"frame_{step:08d}.vtu" for step in steps
    ]


def test_a_frame_of_the_same_step_replaces_the_one_before(tmp_path: Path, frame: Frame) -> None:
    writer = FieldWriter(tmp_path)
    writer.write(frame)
    writer.write(frame)
    assert len(files(tmp_path)) == 2


def test_a_body_without_tool_or_elements_is_written_too(tmp_path: Path) -> None:
    FieldWriter(tmp_path).write(replace(outline_frame(0.0, 0.15), tool=()))
    assert read_last_frame(tmp_path).cells.shape == (0, 3)


def test_missing_or_damaged_fields_are_said_plainly(tmp_path: Path, frame: Frame) -> None:
    with pytest.raises(FieldsError, match="no fields"):
        read_last_frame(tmp_path)
    FieldWriter(tmp_path).write(frame)
    path = tmp_path / files(tmp_path)[0][0]
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(FieldsError, match=path.name):
        read_last_frame(tmp_path)
