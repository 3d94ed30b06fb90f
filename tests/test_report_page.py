"""The report's page as a browser sees it: sections, nothing loaded from elsewhere, nothing that runs."""

from __future__ import annotations

import base64
import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from report_pages import NASTY, Page, history_row, output_directory
from synthetic_cut import CUT, filled_frame

from pfemcut.cli.main import status
from pfemcut.method import ContactView
from pfemcut.output.report import write_report
from pfemcut.output.report.ledgers import energy_ledger, heat_ledger
from pfemcut.output.report.text import with_scatter
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.history import TableWriter, read_table


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = output_directory(tmp_path_factory.mktemp("run"), title=NASTY)
    (directory / "figures").mkdir()
    Image.new("RGB", (40, 30), "red").save(directory / "figures" / "wear_map.png")
    write_report(directory)
    return directory


@pytest.fixture(scope="module")
def html(run: Path) -> str:
    return (run / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_every_element_is_closed_and_all_sections_are_there(page: Page) -> None:
    assert set(page.open) <= {"li", "td", "th", "tr", "p"}
    sections = [attrs["id"] for tag, attrs in page.tags if tag == "section"]
    assert sections == [
        "warnings", "inputs", "results", "forces", "fields", "along-the-tool", "ledgers", "convergence", "further",
        "reproduce",
    ]  # fmt: skip
    targets = {value[1:] for value in page.values("href") if value.startswith("#")}
    assert targets <= set(page.values("id"))


def test_nothing_is_loaded_and_nothing_runs(run: Path, page: Page) -> None:
    tags = {tag for tag, _ in page.tags}
    assert not tags & {"script", "link", "iframe", "object", "embed", "video", "form", "base"}
    sources = page.values("src")
    assert len(sources) == len(list((run / "figures").iterdir())) >= 14
    assert all(re.match(r"data:image/(png|webp);base64,", source) for source in sources)
    assert all(re.match(r"#|data:text/plain", target) for target in page.values("href"))
    assert not any(name.startswith("on") for _, attrs in page.tags for name in attrs)
    styles = "".join(page.text)
    assert "@import" not in styles
    assert "url(" not in styles
    assert "default-src 'none'" in "".join(page.values("content"))


def test_what_users_typed_stays_text(html: str, page: Page) -> None:
    assert "<script" not in html
    assert "".join(page.text).count(NASTY) >= 4


def test_inputs_can_be_taken_from_the_page_as_they_were(run: Path, page: Page) -> None:
    text = (run / "inputs.resolved.toml").read_text(encoding="utf-8")
    (link,) = [value for value in page.values("href") if value.startswith("data:")]
    assert base64.b64decode(link.partition(",")[2]).decode() == text
    assert text in "".join(page.text)


def test_pictures_hold_their_size_and_have_words(page: Page) -> None:
    pictures = [attrs for tag, attrs in page.tags if tag == "img"]
    assert all(int(attrs["width"]) > 20 and int(attrs["height"]) > 20 and attrs["alt"] for attrs in pictures)


def test_a_picture_that_nobody_registered_is_shown_as_a_further_one(html: str) -> None:
    assert "Wear map." in html.split('id="further"')[1].split("</section>")[0]


def test_registered_tables_are_shown_and_long_ones_shortened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pfemcut.output.report import registry

    table = registry.Table("wear.csv", registry.Section.TOOL, "Wear rate")
    monkeypatch.setattr(registry, "TABLES", (table,))
    directory = output_directory(tmp_path)
    with (directory / "wear.csv").open("w", newline="") as file:
        csv.writer(file).writerows(
            [["s (mm)", "rate <b>"], *([i, 2 * i] for i in range(registry.MOST_ROWS + 5))]
        )
    text = write_report(directory, animation=False).read_text(encoding="utf-8")
    section = text.split('id="along-the-tool"')[1].split("</section>")[0]
    assert "Wear rate" in section
    assert "rate &lt;b&gt;" in section
    assert "without its last 5 rows" in section


def test_the_animation_moves_and_can_be_left_out(run: Path, tmp_path: Path) -> None:
    with Image.open(run / "figures" / "chip.webp") as moving:
        assert (moving.format, moving.n_frames) == ("WEBP", 3)
    directory = output_directory(tmp_path)
    assert status(["report", str(directory)]) == 0
    assert (directory / "figures" / "chip.webp").exists()
    assert status(["report", str(directory), "--no-animation"]) == 0
    assert not (directory / "figures" / "chip.webp").exists()
    assert "figure-chip" not in (directory / "report.html").read_text(encoding="utf-8")


def test_a_wrong_scale_is_one_clear_error(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["report", str(run), "--scale", "temperatur=1:2", "--scale", "von_mises=5:1"]) == 2
    told = capsys.readouterr().err
    assert "unknown field 'temperatur'; did you mean 'temperature'?" in told
    assert "given 'von_mises=5:1', must be FIELD=LOW:HIGH" in told


def test_ledgers_leave_what_the_history_says(run: Path) -> None:
    history = read_table(run / "history.csv")
    energy = energy_ledger(history, inertia=False)
    assert energy.left.share == f"{history['energy_error'][-1]:.2%}"
    assert [row.label for row in energy.outgo] == ["Plastic work", "Friction", "Elastic energy"]
    assert [row.label for row in energy.told] == ["Kinetic energy"]
    assert energy_ledger(history, inertia=True).left.share == "0.90%"
    heat = heat_ledger(history)
    assert (heat.left.value, [row.share for row in heat.outgo]) == ("0", ["77.78%", "22.22%"])


def test_a_problem_without_a_tool_has_a_page_without_forces(tmp_path: Path) -> None:
    directory = output_directory(tmp_path)
    (directory / "history.csv").unlink()
    with TableWriter(directory / "history.csv") as table:
        for step in range(1, 21):
            table.append({**history_row(step), "travel": 0.0, "cutting_force": 0.0, "thrust_force": 0.0})
    frame = filled_frame(6.0, 0.15, spacing=0.05)
    empty = np.zeros(0)
    untouched = ContactView(np.zeros(0, dtype=np.int64), empty, empty, empty)
    FieldWriter(directory).write(replace(frame, step=20, tool=(), contact=untouched))
    (directory / "inputs.resolved.toml").write_text('problem = "general"\n[time]\nend = 1.0\n')
    text = write_report(directory).read_text(encoding="utf-8")
    ids = Page(text).values("id")
    assert {"inputs", "results", "fields", "ledgers", "figure-energy", "figure-temperature"} <= set(ids)
    assert not {"forces", "along-the-tool", "figure-chip", "figure-mesh_tip"} & set(ids)
    assert "steady" not in text.split('id="results"')[1].split("</section>")[0].split("<table>")[0]


def test_choices_that_check_warns_of_are_told(tmp_path: Path) -> None:
    directory = output_directory(tmp_path)
    path = directory / "inputs.resolved.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("tip_size = 0.006", "tip_size = 0.02"))
    text = write_report(directory, animation=False).read_text(encoding="utf-8")
    told = text.split('id="warnings"')[1].split("</section>")[0]
    assert "in the case: [mesh] tip_size = 0.02 mm resolves the tip radius of 0.025 mm poorly" in told


def test_numbers_of_the_summary_are_those_of_the_page(run: Path, html: str) -> None:
    summary = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    mean, std = with_scatter(summary["cutting_force"]["mean"], summary["cutting_force"]["std"])
    assert f"{mean} ± {std} N/mm" in html
    assert CUT.depth == 0.1
