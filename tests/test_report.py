"""Report and figures: made from the output directory alone, self-contained, and nothing in them runs."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from synthetic_cut import DEPTH, filled_frame

from pfemcut.output.directory import OutputError
from pfemcut.output.drawing import cutting_zone
from pfemcut.output.figures import nodal_average, von_mises_of_average_stress
from pfemcut.output.report import write_report
from pfemcut.output.report.text import figure_text, significant
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.history import TableWriter, read_table
from pfemcut.results.summary import summarise, write_summary


def output_directory(directory: Path, title: str = "Rake 6") -> Path:
    with TableWriter(directory / "history.csv") as table:
        for step in range(1, 201):
            table.append(
                {
                    "step": step,
                    "travel": 0.5 * step / 200,
                    "cutting_force": 200.0 + (-1.0) ** step,
                    "thrust_force": 80.0,
                    "tool_work": 0.1 * step,
                    "plastic_work": 0.095 * step,
                    "energy_error": 0.05,
                }
            )
    FieldWriter(directory).write(filled_frame(6.0, 0.15, curl=0.6, spacing=0.04))
    (directory / "inputs.resolved.toml").write_text('title = "<i>a</i>"\n[cutting]\ndepth = 0.1\n')
    timing = {"step": np.arange(2.0), "momentum": np.array([0.05, 0.05]), "total": np.array([0.1, 0.1])}
    summary = summarise(
        read_table(directory / "history.csv"),
        timing,
        title=title,
        finished=True,
        ending="done",
        depth=0.1,
        rake=6.0,
    )
    write_summary(directory / "summary.json", summary)
    return directory


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    directory = output_directory(tmp_path_factory.mktemp("run"), title="<script>alert(1)</script>")
    return write_report(directory).read_text(encoding="utf-8")


def test_text_of_a_case_cannot_become_code(page: str) -> None:
    assert "<script>" not in page
    assert "<i>a</i>" not in page
    assert "&lt;script&gt;" in page


def test_report_has_results_with_units_definitions_ledgers_warnings_and_inputs(page: str) -> None:
    results = page.split('id="results"')[1].split("</table>")[0]
    assert "<td>Cutting force" in results
    assert "200.0 ± 1.0" in results
    assert "N/mm" in results
    assert "Force on the tool against its motion" in results
    assert "95.00%" in page.split('id="ledgers"')[1]
    assert "energy_error is 5.00%" in page.split('class="warnings"')[1].split("</section>")[0]
    assert "depth = 0.1" in page


def test_figures_are_written_beside_the_report_and_show_something(tmp_path: Path) -> None:
    write_report(output_directory(tmp_path))
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    fields = ("temperature", "plastic_strain", "strain_rate", "von_mises", "mesh", "mesh_tip")
    expected = ("forces", *fields, "profiles", "energy")
    assert names == {f"{name}.png" for name in expected}
    for name in names:
        image = matplotlib.image.imread(tmp_path / "figures" / name)
        assert image[..., :3].std() > 0.05, name


def test_a_directory_without_a_run_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="summary.json: can't be read.*directory of a run"):
        write_report(tmp_path)
    output_directory(tmp_path)
    (tmp_path / "summary.json").write_text("{")
    with pytest.raises(OutputError, match="damaged"):
        write_report(tmp_path)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (123.456, "123.5"),
        (0.012345, "0.01235"),
        (98765.4, "98765"),
        (1.5e7, "15000000"),
        (1e-9, "1.000e-09"),
    ],
)
def test_numbers_have_the_digits_that_mean_something(value: float, text: str) -> None:
    assert significant(value) == text


def test_a_figure_without_scatter_is_not_given_one() -> None:
    assert figure_text({"value": 0.02, "unit": "-"}) == "0.02000"
    assert figure_text({"mean": 200.0, "std": 1.234, "unit": "-"}) == "200.0 ± 1.2"


def test_nodal_average_keeps_constants_and_linear_fields_inside() -> None:
    frame = filled_frame(0.0, 0.15, spacing=0.05)
    assert nodal_average(frame, np.full(len(frame.cells), 7.0))[frame.cells] == pytest.approx(7.0)


def test_stress_that_alternates_between_elements_has_no_von_mises_picture() -> None:
    frame = filled_frame(0.0, 0.15, spacing=0.02)
    sign = np.where(np.arange(len(frame.cells)) % 2 == 0, 1.0, -1.0)
    stress = np.column_stack([500.0 * sign, -500.0 * sign, 0.0 * sign, 0.0 * sign])
    frame = type(frame)(**{**frame.__dict__, "cell_fields": {**frame.cell_fields, "cauchy_stress": stress}})
    norms = np.sqrt(3.0) * 500.0
    assert np.median(von_mises_of_average_stress(frame)) < 0.5 * norms


def test_view_holds_the_tip_and_the_whole_chip() -> None:
    frame = filled_frame(6.0, 0.15, curl=0.6, spacing=0.04)
    low, high = cutting_zone(frame, DEPTH)
    chip = frame.points[frame.points[:, 1] > 0.15]
    assert (chip > low).all()
    assert (chip < high).all()
    assert (low < 0.0).all()
    assert high[0] < 0.5
