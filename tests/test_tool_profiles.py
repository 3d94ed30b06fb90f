"""Profiles along the tool: exact answers of drawn contacts, what a run records, and what is rebuilt from its folder."""

from __future__ import annotations

import csv
import shutil
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
import tomli_w
from synthetic_cut import CUT, DEPTH, TIP, filled_frame, from_rake_frame, outline_frame, tool_of

from pfemcut.cli.main import status
from pfemcut.method import ContactView, Frame
from pfemcut.output.directory import PROFILES
from pfemcut.output.profile_figure import write_profile_figure
from pfemcut.output.tool_profiles import CutProfiles, cut_profiles, write_table
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.contact_table import append_contact, read_contact
from pfemcut.results.derived.profile_figures import profile_figures
from pfemcut.results.derived.tool_profiles import (
    ToolLoads,
    averaged_profiles,
    facing_halves,
    force_of_profiles,
    force_on_tool,
    tool_loads,
)
from pfemcut.results.history import TableWriter
from pfemcut.tools.rigid_wedge import RigidWedge
from pfemcut.wear.load import wear_of, wear_table

SPEED = (-CUT.speed, 0.0)
CONTACT = 0.15


def loaded(frame: Frame, pressure: float, shear: float) -> Frame:
    """``frame`` with one pressure and one shear traction on all that is in contact."""
    particles = frame.contact.particles
    ones = np.ones(particles.size)
    view = ContactView(particles, frame.contact.arc_length, pressure * ones, shear * ones)
    return replace(frame, contact=view)


def sliding(frame: Frame, velocity: tuple[float, float]) -> Frame:
    """``frame`` with all particles moving with one velocity."""
    fields = {**frame.point_fields, "velocity": np.tile(velocity, (len(frame.points), 1))}
    return replace(frame, point_fields=fields)


def strip(begin: float, end: float, pieces: int = 7, **values: float) -> ToolLoads:
    """Neighbouring stretches of uneven lengths that together cover the tool from ``begin`` to ``end``."""
    borders = begin + (end - begin) * np.linspace(0.0, 1.0, pieces + 1) ** 1.5
    given = {"pressure": 100.0, "shear": 20.0, "sliding_speed": 500.0, "temperature": 800.0, **values}
    columns = {name: np.full(pieces, value) for name, value in given.items()}
    columns.setdefault("tool_temperature", np.full(pieces, np.nan))
    return ToolLoads(0.5 * (borders[1:] + borders[:-1]), borders[:-1], borders[1:], **columns)


@pytest.mark.parametrize("rake", [-10.0, 0.0, 6.0])
def test_stretches_of_particles_join_and_cover_the_contact(rake: float) -> None:
    """On the straight rake face to round-off; on the edge's polygon to the square of its angles."""
    frame = outline_frame(rake, 0.2, contact=CONTACT)
    loads = tool_loads(frame, SPEED)
    order = np.argsort(loads.arc)
    begin, end, arc = loads.begin[order], loads.end[order], loads.arc[order]
    on_rake = arc > 1e-9
    assert begin[on_rake][1:] == pytest.approx(end[on_rake][:-1], abs=1e-12)
    assert end[:-1] == pytest.approx(begin[1:], abs=2e-3 * TIP)
    # The last particle's stretch reaches half an edge beyond it.
    assert end[-1] > CONTACT
    assert end[-1] < CONTACT + 0.002


def test_a_corner_that_turns_away_from_the_tool_adds_no_length() -> None:
    """The edge after the last particle leaves the rake face at a right angle, so its half does not face the tool."""
    tool = RigidWedge((0.0, 0.0), 0.0, 5.0, TIP)
    corners = from_rake_frame(tool, np.array([0.0, 0.1, 0.1]), np.array([0.0, 0.0, 0.3]))
    edges = np.array([[0, 1], [1, 2]])
    before, after = facing_halves(tool, corners, edges)
    assert before == pytest.approx([0.0, 0.05, 0.0])
    assert after == pytest.approx([0.05, 0.0, 0.0], abs=1e-15)


@pytest.mark.parametrize("rake", [-10.0, 0.0, 6.0])
def test_uniform_pressure_gives_the_force_of_its_projection(rake: float) -> None:
    """p over a curve from a to b is p times the chord turned by 90 degrees: the tip's polygon costs 1e-3 of it."""
    frame = loaded(outline_frame(rake, 0.2, contact=CONTACT), 1000.0, 0.0)
    tool = frame.tool[0]
    loads = tool_loads(frame, SPEED)
    chord = points_at(tool, loads.end.max()) - points_at(tool, loads.begin.min())
    exact = 1000.0 * np.array([chord[1], -chord[0]])
    assert force_on_tool(loads, tool) == pytest.approx(exact, rel=2e-3, abs=0.2)
    profiles = averaged_profiles([loads], tool, DEPTH)
    assert force_of_profiles(profiles, tool) == pytest.approx(force_on_tool(loads, tool), rel=2e-3, abs=0.2)
    inside = (profiles.contact > 1.0 - 1e-9) & profiles.stations.on("rake")
    assert np.count_nonzero(inside) > 30
    assert profiles.quantities["pressure"].mean[inside] == pytest.approx(1000.0)


def points_at(tool: RigidWedge, arc: float) -> np.ndarray:
    """The point of the tool at an arc length on its rake face or edge."""
    if arc > 0.0:
        return tool.rake_tangent_point + arc * tool.rake_direction
    angle = -arc / tool.tip_radius
    return np.asarray(tool.centre) + tool.tip_radius * (
        np.cos(angle) * tool.rake_normal - np.sin(angle) * tool.rake_direction
    )


@pytest.mark.parametrize("stretch", [(-0.06, -0.03), (-0.02, 0.013), (0.0531, 0.0542), (0.0, 0.1)])
def test_length_times_traction_is_the_sum_of_the_forces(stretch: tuple[float, float]) -> None:
    """Whatever the stretches and the stations, also where a stretch is shorter than a station."""
    loads = strip(*stretch)
    profiles = averaged_profiles([loads], tool_of(0.0), DEPTH)
    length = profiles.stations.length
    assert length @ profiles.quantities["pressure"].mean == pytest.approx(100.0 * (stretch[1] - stretch[0]))
    assert length @ profiles.quantities["shear"].mean == pytest.approx(20.0 * (stretch[1] - stretch[0]))
    assert length @ profiles.contact == pytest.approx(stretch[1] - stretch[0])


@pytest.mark.parametrize("rake", [-10.0, 0.0, 6.0])
def test_a_chip_that_slides_as_a_rigid_body_slides_with_its_speed(rake: float) -> None:
    tool = tool_of(rake)
    velocity = 1234.0 * tool.rake_direction + np.asarray(SPEED)
    frame = loaded(outline_frame(rake, 0.2, contact=CONTACT), 1000.0, 150.0)
    frame = sliding(frame, (float(velocity[0]), float(velocity[1])))
    profiles = averaged_profiles([tool_loads(frame, SPEED)], tool, DEPTH)
    on_rake = profiles.stations.on("rake")
    assert profiles.quantities["sliding_speed"].mean[on_rake] == pytest.approx(1234.0)
    full = on_rake & (profiles.contact > 1.0 - 1e-9)
    assert profiles.quantities["shear"].mean[full] == pytest.approx(150.0)
    assert profiles.quantities["heat_flux"].mean[full] == pytest.approx(150.0 * 1234.0)
    assert profiles.friction()[full] == pytest.approx(0.15)


def test_material_at_rest_slides_down_edge_and_flank() -> None:
    """The tool passes: on the edge the speed is that of the tangent, and friction drags the edge backwards."""
    frame = sliding(loaded(outline_frame(0.0, 0.2), 1000.0, 100.0), (0.0, 0.0))
    loads = tool_loads(frame, SPEED)
    edge = loads.arc < 0.0
    assert loads.sliding_speed[edge] == pytest.approx(CUT.speed * np.sin(loads.arc[edge] / TIP))
    assert (loads.shear[edge] < 0.0).all()


def test_pressure_pushes_back_and_friction_up_the_rake_pushes_out() -> None:
    tool = tool_of(0.0)
    assert force_on_tool(strip(0.0, 0.1, shear=0.0), tool) == pytest.approx([10.0, 0.0])
    assert force_on_tool(strip(0.0, 0.1, pressure=0.0), tool) == pytest.approx([0.0, 2.0])
    # On the flank of 5 degrees the workpiece pushes the tool up, and drags it back.
    arc = TIP * tool.arc_angle
    flank = force_on_tool(strip(-arc - 0.02, -arc, shear=-20.0), tool)
    cosine, sine = np.cos(np.radians(5.0)), np.sin(np.radians(5.0))
    assert flank == pytest.approx(
        [0.02 * (20.0 * cosine - 100.0 * sine), 0.02 * (100.0 * cosine + 20.0 * sine)]
    )


def test_mean_and_scatter_are_over_the_instants() -> None:
    """Tractions count as zero where there is no contact; speeds and temperatures are those of what touches."""
    short, long = strip(0.0, 0.04, temperature=700.0), strip(0.0, 0.08, pressure=300.0, temperature=900.0)
    profiles = averaged_profiles([short, long], tool_of(0.0), DEPTH)
    at = np.argmin(np.abs(profiles.stations.position - 0.06))
    near = np.argmin(np.abs(profiles.stations.position - 0.02))
    pressure, warmth = profiles.quantities["pressure"], profiles.quantities["temperature"]
    assert (pressure.mean[near], pressure.std[near]) == pytest.approx((200.0, 100.0))
    assert (pressure.mean[at], pressure.std[at]) == pytest.approx((150.0, 150.0))
    assert (warmth.mean[near], warmth.std[near]) == pytest.approx((800.0, 100.0))
    assert (warmth.mean[at], warmth.std[at]) == pytest.approx((900.0, 0.0))
    assert profiles.contact[[near, at]] == pytest.approx([1.0, 0.5])
    assert np.isnan(warmth.mean[profiles.stations.on("edge")]).all()


def test_wear_rate_is_the_mean_of_rates_not_the_rate_of_means() -> None:
    law = wear_of({"A": 1e-3, "B": 20000.0})
    hot, cold = strip(0.0, 0.1, temperature=1200.0), strip(0.0, 0.1, temperature=800.0)
    rates = [1e-3 * 100.0 * 500.0 * np.exp(-20000.0 / temperature) for temperature in (1200.0, 800.0)]
    profiles = averaged_profiles([hot, cold], tool_of(0.0), DEPTH, (law,))
    on_rake = profiles.stations.on("rake")
    wear = profiles.quantities["wear_rate"]
    assert wear.mean[on_rake] == pytest.approx(np.mean(rates))
    figures = profile_figures(profiles)
    assert figures["crater_wear_rate"] == {
        "mean": pytest.approx(np.mean(rates)),
        "std": pytest.approx(np.std(rates)),
        "unit": "mm/s",
    }
    # Nothing touches edge and flank: no rates of theirs.
    assert {name for name in figures if "wear" in name} == {"crater_wear_rate", "crater_wear_position"}


def test_a_conducting_tool_wears_at_its_own_temperature() -> None:
    law = wear_of({"A": 1e-3, "B": 20000.0})
    loads = strip(0.0, 0.1, temperature=1200.0, tool_temperature=1000.0)
    profiles = averaged_profiles([loads], tool_of(0.0), DEPTH, (law,))
    on_rake = profiles.stations.on("rake")
    assert profiles.quantities["wear_rate"].mean[on_rake] == pytest.approx(50.0 * np.exp(-20.0))
    assert profiles.quantities["tool_temperature"].mean[on_rake] == pytest.approx(1000.0)


def test_wear_of_the_flank_is_the_mean_over_its_contact() -> None:
    """Half of the flank's length in contact wears twice as fast as the other half."""
    tool = tool_of(0.0)
    low, size = -TIP * tool.arc_angle, DEPTH / 25.0
    law = wear_of({"A": 1e-3, "B": 0.0})
    near, far = strip(low - size, low), strip(low - 2.0 * size, low - size, sliding_speed=-1000.0)
    both = ToolLoads(*(np.concatenate([getattr(far, name), getattr(near, name)]) for name in vars(near)))
    figures = profile_figures(averaged_profiles([both], tool, DEPTH, (law,)))
    assert figures["flank_wear_rate"]["mean"] == pytest.approx(1e-3 * 100.0 * 750.0)


def test_contact_table_reads_back_to_seven_digits(tmp_path: Path) -> None:
    first, second = strip(0.0, 0.1, temperature=700.0), strip(-0.03, 0.2, pieces=4, tool_temperature=650.0)
    for step, loads in ((10, first), (20, ToolLoads.none()), (30, second)):
        append_contact(tmp_path / "contact.csv", step, loads)
    steps, read = read_contact(tmp_path / "contact.csv")
    assert steps.tolist() == [10, 20, 30]
    for name in vars(first):
        for before, after in ((first, read[0]), (second, read[2])):
            assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-6, nan_ok=True)
    assert (read[1].end - read[1].begin).sum() == 0.0
    assert read_contact(tmp_path / "none.csv")[1] == []


INPUTS = {
    "cutting": {"speed": CUT.speed, "depth": DEPTH},
    "tool": {"rake": 0.0, "clearance": 5.0, "tip_radius": TIP},
    "contact": {"conductance": 0.0},
}


def run_folder(directory: Path, wear: str = "", frames: tuple[int, ...] = (600,)) -> Path:
    """A run of 1000 steps and 1 mm whose pressure rises from 0 to 1000 MPa."""
    directory.mkdir(exist_ok=True)
    with TableWriter(directory / "history.csv") as table:
        for step in range(1, 1001):
            table.append(
                {
                    "step": step,
                    "time": 1e-7 * step,
                    "dt": 1e-7,
                    "travel": 1e-3 * step,
                    "cutting_force": 100.0,
                }
            )
            if step % 10 == 0:
                append_contact(directory / "contact.csv", step, strip(-0.05, 0.1, pressure=float(step)))
    tool = {**INPUTS["tool"], **({"wear": wear_table(wear, Path())} if wear else {})}
    (directory / "inputs.resolved.toml").write_text(tomli_w.dumps({**INPUTS, "tool": tool}))
    writer = FieldWriter(directory)
    for step in frames:
        writer.write(filled_frame(0.0, 0.15, spacing=0.04, step=step))
    return directory


def only(found: tuple[CutProfiles, ...]) -> CutProfiles:
    assert len(found) == 1
    return found[0]


def test_only_records_of_the_steady_window_count(tmp_path: Path) -> None:
    found = only(cut_profiles(run_folder(tmp_path)))
    assert found.profiles.instants == 26
    assert found.travel == pytest.approx((0.75, 1.0))
    inside = found.profiles.contact > 1.0 - 1e-9
    assert found.profiles.quantities["pressure"].mean[inside] == pytest.approx(875.0)
    assert "wear_rate" not in found.profiles.quantities


def test_a_run_without_records_falls_back_on_its_frames(tmp_path: Path) -> None:
    directory = run_folder(tmp_path, frames=(600, 800, 900))
    (directory / "contact.csv").unlink()
    found = only(cut_profiles(directory))
    assert (found.profiles.instants, found.travel) == (2, pytest.approx((0.8, 0.9)))
    # The drawn pressure falls linearly from 180 MPa at the tangent point to 30 MPa at the end of contact.
    half = np.argmin(np.abs(found.profiles.stations.position - 0.5 * CONTACT))
    assert found.profiles.quantities["pressure"].mean[half] == pytest.approx(105.0, rel=0.02)


def test_records_of_the_end_alone_do_not_stand_for_the_window(tmp_path: Path) -> None:
    directory = run_folder(tmp_path, frames=(600, 800, 900))
    rows = (directory / "contact.csv").read_text().splitlines(keepends=True)
    late = [row for row in rows[1:] if int(row.split(",")[0]) > 900]
    (directory / "contact.csv").write_text("".join([rows[0], *late]))
    assert only(cut_profiles(directory)).profiles.instants == 2


def test_what_holds_no_cut_has_no_profiles(tmp_path: Path) -> None:
    assert cut_profiles(tmp_path) == ()
    directory = run_folder(tmp_path / "a")
    (directory / "inputs.resolved.toml").write_text('problem = "general"\n')
    assert cut_profiles(directory) == ()
    assert write_profile_figure(directory) == []


def test_table_and_picture_are_rebuilt_from_the_folder_alone(tmp_path: Path) -> None:
    directory = run_folder(tmp_path / "run", wear="p20_carbon_steel")
    write_table(directory, only(cut_profiles(directory)).profiles)
    written = (directory / PROFILES).read_bytes()
    moved = shutil.move(directory, tmp_path / "elsewhere")
    (moved / PROFILES).unlink()
    (picture,) = write_profile_figure(moved)
    assert (moved / PROFILES).read_bytes() == written
    assert matplotlib.image.imread(picture)[..., :3].std() > 0.05


def test_columns_of_the_table(tmp_path: Path) -> None:
    directory = run_folder(tmp_path, wear="p20_carbon_steel")
    write_profile_figure(directory)
    with (directory / PROFILES).open() as file:
        rows = list(csv.DictReader(file))
    quantities = ("pressure", "shear", "sliding_speed", "temperature", "heat_flux", "wear_rate")
    expected = {"position", "length", "part", "contact", "friction"}
    assert set(rows[0]) == expected.union(*({name, f"{name}_std"} for name in quantities))
    parts = [row["part"] for row in rows]
    assert list(dict.fromkeys(parts)) == ["flank", "edge", "rake"]
    assert float(rows[-1]["wear_rate"]) > 0.0
    assert float(rows[-1]["friction"]) == pytest.approx(20.0 / 875.0, rel=1e-3)


def test_command_writes_and_prints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    directory = run_folder(tmp_path / "run")
    assert status(["profiles", str(directory)]) == 0
    assert (directory / "figures" / "tool_profiles.png").exists()
    shown = capsys.readouterr().out
    assert "26 instants, travel 0.75 to 1 mm" in shown
    assert "wear" not in shown
    before = (directory / PROFILES).read_bytes()
    other = ["profiles", str(directory), "--wear", "p20_carbon_steel"]
    assert status([*other, "-o", str(tmp_path / "other")]) == 0
    shown = capsys.readouterr().out
    assert "crater_wear_rate" in shown
    assert "Unconfirmed" in shown
    assert "wear_rate" in (tmp_path / "other" / PROFILES).read_text()
    assert (directory / PROFILES).read_bytes() == before
    assert status(other) == 2
    assert status(["profiles", str(tmp_path)]) == 2
    assert "holds no cut with contact" in capsys.readouterr().err
