"""The names that scripts and notebooks use: cases, step-by-step runs, callbacks, fields, results; and the notebook."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from problems import SHORT_CUT
from test_driver import ChaoticMethod, run, summary_in

import pfemcut
from pfemcut.fields import UNITS
from pfemcut.moment import Callbacks, Moment
from pfemcut.results.checkpoint import read_checkpoint

ROOT = Path(__file__).parents[1]
CHANGES = {"cutting.travel": 0.003, "mesh.growth": 0.3, "output.figures": False, "output.every": 2}


def small_case(**changes: object) -> pfemcut.LoadedCase:
    return pfemcut.load_case(SHORT_CUT, {**CHANGES, **changes})


@pytest.fixture(scope="module")
def simulation() -> Iterator[pfemcut.Simulation]:
    """A few steps of a cut; tests look at it and don't change it."""
    made = pfemcut.Simulation(small_case())
    made.run()
    yield made


def test_importing_pfemcut_is_quick_and_its_names_are_there() -> None:
    script = (
        "import sys, pfemcut\n"
        "slow = {'numpy', 'pydantic', 'dolfinx', 'mpi4py', 'matplotlib', 'scipy', 'meshio', 'pyvista'}\n"
        "print(sorted(slow & set(sys.modules)))\n"
        "pfemcut.load_case, pfemcut.run, pfemcut.Simulation\n"
        "print(sorted({'dolfinx', 'mpi4py', 'matplotlib', 'pyvista', 'vtk'} & set(sys.modules)))\n"
    )
    printed = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout
    assert printed.splitlines() == ["[]", "[]"]
    for name in pfemcut.__all__:
        assert name in dir(pfemcut)
        assert getattr(pfemcut, name).__doc__
    with pytest.raises(AttributeError, match="no attribute 'simulate'"):
        pfemcut.simulate  # noqa: B018


def test_a_case_is_loaded_from_a_table_with_changes() -> None:
    case = small_case(**{"workpiece.material.taylor_quinney": 0.8})
    assert case.case.cutting.travel == 0.003
    assert case.material.taylor_quinney == 0.8
    assert "0.003 mm at 3330 mm/s" in case.figures()["cut"]
    assert any("too short for steady means" in text for text in case.warnings())
    assert pfemcut.load_case(SHORT_CUT).case.cutting.travel == 0.5


def test_a_case_from_a_file_finds_files_beside_it(tmp_path: Path) -> None:
    case = small_case()
    (tmp_path / "case.toml").write_text(case.toml())
    assert pfemcut.load_case(tmp_path / "case.toml").toml() == case.toml()


@pytest.mark.parametrize(
    ("source", "changes", "words"),
    [
        ("nowhere.toml", {}, "no such file"),
        (SHORT_CUT, {"cutting.sped": 1.0}, r"did you mean 'speed'"),
        (SHORT_CUT, {"cutting.speed.x": 1.0}, "is not a table"),
        (SHORT_CUT, {"cutting.speed": "fast"}, "or a number"),
        ({}, {}, "missing"),
    ],
)
def test_a_wrong_case_is_a_user_error(source: object, changes: dict, words: str) -> None:
    with pytest.raises(pfemcut.UserError, match=words):
        pfemcut.load_case(source, changes)  # type: ignore[arg-type]


def test_a_simulation_counts_its_steps(simulation: pfemcut.Simulation) -> None:
    assert simulation.finished
    assert simulation.measures.travel == pytest.approx(0.003, rel=1e-9)
    history = simulation.history
    assert history["step"].tolist() == list(range(1, simulation.measures.step + 1))
    assert history["cutting_force"][-1] == simulation.measures.cutting_force > 0.0
    with pytest.raises(pfemcut.UserError, match="finished"):
        simulation.step()


def test_a_simulation_gives_what_a_run_writes_bit_for_bit(
    simulation: pfemcut.Simulation, tmp_path: Path
) -> None:
    steps: list[int] = []
    results = pfemcut.run(
        small_case(), tmp_path, after_step=lambda moment: steps.append(moment.measures.step)
    )
    assert results.finished and steps == results.history["step"].tolist()
    assert results.history.keys() == simulation.history.keys()
    for name, values in results.history.items():
        np.testing.assert_array_equal(values, simulation.history[name], err_msg=name)
    assert results.steps[-1] == steps[-1]
    read = results.fields()
    np.testing.assert_array_equal(read.points, simulation.fields.points)
    np.testing.assert_array_equal(read["temperature"], simulation.fields["temperature"])
    with pytest.raises(pfemcut.UserError, match="no fields of step 99"):
        results.fields(99)


def test_a_saved_simulation_goes_on_bit_for_bit(simulation: pfemcut.Simulation, tmp_path: Path) -> None:
    first = pfemcut.Simulation(small_case())
    first.run(steps=3)
    assert first.measures.step == 3
    first.save(tmp_path / "checkpoint.h5")
    second = pfemcut.Simulation(small_case(), checkpoint=tmp_path)
    assert second.run() == simulation.measures
    with pytest.raises(pfemcut.UserError, match="cutting.speed"):
        pfemcut.Simulation(small_case(**{"cutting.speed": 3000.0}), checkpoint=tmp_path)
    with pytest.raises(pfemcut.UserError, match="can't be written"):
        second.save(tmp_path / "none/checkpoint.h5")


def test_a_simulation_stops_where_asked_and_goes_on() -> None:
    simulation = pfemcut.Simulation(small_case())
    simulation.run(travel=0.001)
    assert 0.001 <= simulation.measures.travel < 0.0019
    step = simulation.measures.step
    simulation.run(before_step=lambda moment: moment.stop())
    assert simulation.measures.step == step
    simulation.run(after_step=lambda moment: moment.stop("enough"))
    assert simulation.measures.step == step + 1


def test_fields_are_arrays_with_units_that_cannot_be_written_to(simulation: pfemcut.Simulation) -> None:
    fields = simulation.fields
    particles, elements = len(fields.points), len(fields.cells)
    of_laminae = {"damage", "fibre_damage", "matrix_damage"}
    assert set(fields.names) == set(UNITS) - of_laminae
    for name in fields.names:
        assert len(fields[name]) in (particles, elements) and fields.unit(name)
        with pytest.raises(ValueError, match="read-only"):
            fields[name][0] = 0
    assert fields["cauchy_stress"].shape == (elements, 4)
    assert fields.at_particles("von_mises").shape == (particles,)
    np.testing.assert_array_equal(fields.at_particles("temperature"), fields["temperature"])
    with pytest.raises(pfemcut.UserError, match="did you mean 'temperature'"):
        fields["temprature"]
    with pytest.raises(pfemcut.UserError, match="4 components"):
        fields.at_particles("cauchy_stress")


def test_average_of_a_constant_is_that_constant(simulation: pfemcut.Simulation) -> None:
    frame = simulation.fields.frame
    constant = {**frame.cell_fields, "von_mises": np.full(len(frame.cells), 7.0)}
    fields = pfemcut.Fields(frame.__class__(**{**vars(frame), "cell_fields": constant}))
    np.testing.assert_allclose(fields.at_particles("von_mises"), 7.0, rtol=1e-12)


def test_fields_as_a_meshio_mesh(simulation: pfemcut.Simulation) -> None:
    fields = simulation.fields
    mesh = fields.to_meshio()
    np.testing.assert_array_equal(mesh.points[:, :2], fields.points)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], fields.cells)
    assert set(fields.names) <= {*mesh.point_data, *mesh.cell_data}


def test_without_pyvista_the_error_says_what_to_install(
    simulation: pfemcut.Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(pfemcut.UserError, match="pip install pyvista"):
        simulation.fields.to_pyvista()


def test_fields_as_a_pyvista_grid(simulation: pfemcut.Simulation) -> None:
    pytest.importorskip("pyvista")
    fields = simulation.fields
    grid = fields.to_pyvista()
    assert (grid.n_points, grid.n_cells) == (len(fields.points), len(fields.cells))
    np.testing.assert_array_equal(grid.point_data["temperature"], fields["temperature"])
    np.testing.assert_array_equal(grid.cell_data["von_mises"], fields["von_mises"])
    lengths = grid.compute_cell_sizes(length=False, volume=False)["Area"]
    corners = fields.points[fields.cells]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    np.testing.assert_allclose(lengths, areas, rtol=1e-10)


def test_callbacks_are_called_round_each_step(tmp_path: Path) -> None:
    calls: list[tuple[str, int]] = []

    def noting(name: str):
        return lambda moment: calls.append((name, moment.measures.step))

    run(tmp_path, last=3, callbacks=Callbacks(noting("before"), noting("after")))
    assert calls == [(name, step + (name == "after")) for step in range(3) for name in ("before", "after")]


def stop_at(step: int):
    def callback(moment: Moment) -> None:
        if moment.measures.step == step:
            moment.stop("seen enough")

    return callback


@pytest.mark.parametrize("when", ["before_step", "after_step"])
def test_a_callback_stops_a_run_that_can_be_resumed(tmp_path: Path, when: str) -> None:
    summary = run(tmp_path / "stopped", callbacks=Callbacks(**{when: stop_at(7)}))
    assert (summary.finished, summary.ending) == (False, "stopped by a callback: seen enough")
    assert read_checkpoint(tmp_path / "stopped").step == 7
    run(tmp_path / "stopped", resume=True)
    run(tmp_path / "whole")
    whole, resumed = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "stopped"))
    assert resumed == whole


def test_a_wish_to_stop_after_the_last_step_leaves_a_finished_run(tmp_path: Path) -> None:
    assert run(tmp_path, last=5, callbacks=Callbacks(after_step=stop_at(5))).finished


def test_an_error_in_a_callback_is_raised_again_and_the_run_can_be_resumed(tmp_path: Path) -> None:
    def fail(moment: Moment) -> None:
        if moment.measures.step == 6:
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        run(tmp_path, callbacks=Callbacks(after_step=fail))
    assert read_checkpoint(tmp_path).step == 6
    assert summary_in(tmp_path)["ending"] == "a callback raised ZeroDivisionError: mine"


def test_measures_and_fields_of_a_moment_are_the_method_s() -> None:
    method = ChaoticMethod(3)
    method.advance()
    moment = Moment(method)
    assert (moment.measures, moment.own_measures) == (method.measure(), method.own_measures())
    np.testing.assert_array_equal(moment.fields["velocity"], method.frame().point_fields["velocity"])


def test_the_notebook_runs(tmp_path: Path) -> None:
    environment = {**os.environ, "MPLBACKEND": "Agg", "TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    result = subprocess.run(
        [sys.executable, ROOT / "docs/first_cut.py"],
        env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert "warning" not in result.stderr.lower()
    assert "hottest:" in result.stdout
