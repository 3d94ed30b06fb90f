"""The report's page as a browser sees it: sections, nothing loaded from elsewhere, nothing that runs."""

from __future__ import annotations

import base64
import csv
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from synthetic_cut import CUT, filled_frame

from pfemcut.case.load import resolved_toml, validated
from pfemcut.cli.main import status
from pfemcut.inputs import InputError
from pfemcut.method import ContactView
from pfemcut.output.figures import FIELDS, colour_scale
from pfemcut.output.report import write_report
from pfemcut.output.report.inputs import tables
from pfemcut.output.report.ledgers import energy_ledger, heat_ledger
from pfemcut.output.report.results import trend
from pfemcut.output.report.text import converted, number, shown, with_scatter
from pfemcut.output.scales import four_decades, from_zero, given_scales, round_up, temperature_scale
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.derived.steady_window import steady_window
from pfemcut.results.history import TableWriter, read_table
from pfemcut.results.summary import summarise, write_summary
from pfemcut.units import unit_and_words

NASTY = "</pre><script>alert(1)</script><img src=http://evil.example/x.png>"
VOID = {"meta", "img", "br", "link"}


class Page(HTMLParser):
    """Elements of a page; fails where one is closed that isn't open."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.text: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("li", "td", "th", "tr", "p") and self.open[-1] != tag:
            return
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text.append(data)

    def values(self, attribute: str) -> list[str]:
        return [attrs[attribute] for _, attrs in self.tags if attribute in attrs]


def inputs_text(title: str) -> str:
    case, material = validated(
        {
            "title": title,
            "workpiece": {
                "length": 3.0,
                "height": 1.0,
                "material": {"base": "aisi4340", "young_modulus": 2.1e5, "source": NASTY},
            },
            "tool": {"tip_radius": 0.025, "rake": 6.0},
            "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.5},
            "contact": {"friction": {"law": "sticking-sliding", "coefficient": 0.2, "shear_limit": 500.0}},
            "time": {"step": 1e-7},
            "mesh": {"tip_size": 0.006},
        },
        Path(),
    )
    return resolved_toml(case, material)


def history_row(step: int) -> dict[str, float]:
    work = 0.1 * step
    return {
        "step": step,
        "time": 1e-7 * step,
        "dt": 1e-7,
        "travel": 0.5 * step / 200,
        "cutting_force": 200.0 + (-1.0) ** step,
        "thrust_force": 80.0,
        "max_temperature": 800.0 + 0.1 * step,
        "tool_work": work,
        "plastic_work": 0.9 * work,
        "friction_work": 0.08 * work,
        "elastic_energy": 0.01 * work,
        "kinetic_energy": 0.001 * work,
        "energy_error": 0.01,
        "nodes": 1000 + step,
        "newton_iterations": 2 + step % 3,
        "step_cuts": step // 50,
        "inserted": 3,
        "removed": 2,
        "heat_generated": 0.9 * work,
        "heat_content": 0.7 * work,
        "heat_to_tool": 0.2 * work,
        "heat_error": 0.0,
    }


def output_directory(directory: Path, title: str = "Rake 6") -> Path:
    with TableWriter(directory / "history.csv") as table:
        for step in range(1, 201):
            table.append(history_row(step))
    fields = FieldWriter(directory)
    frame = filled_frame(6.0, 0.15, curl=0.6, spacing=0.05)
    for step in (50, 100, 200):
        fields.write(replace(frame, step=step, travel=0.5 * step / 200))
    (directory / "inputs.resolved.toml").write_text(inputs_text(title), encoding="utf-8")
    timing = {"step": np.arange(2.0), "momentum": np.array([0.05, 0.05]), "total": np.array([0.1, 0.1])}
    summary = summarise(
        read_table(directory / "history.csv"),
        timing,
        title=title,
        finished=True,
        ending=f"done {NASTY}",
        depth=0.1,
        rake=6.0,
        warnings=(NASTY,),
    )
    write_summary(directory / "summary.json", summary)
    return directory


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


def test_scales_end_at_round_numbers_and_can_be_given() -> None:
    assert [round_up(value) for value in (1.0, 1.01, 2.5, 7.0, 0.021, 950.0)] == [
        1.0,
        1.5,
        3.0,
        8.0,
        0.03,
        1000.0,
    ]
    warm = temperature_scale(np.array([293.15, 814.0]))
    assert (warm.vmin, warm.vmax) == (290.0, 900.0)
    assert from_zero(np.full(1000, 1.7)).vmax == 2.0
    rate = four_decades(np.array([3.0e5]))
    assert (rate.vmin, rate.vmax) == (pytest.approx(100.0), pytest.approx(1e6))
    frame = filled_frame(6.0, 0.15, spacing=0.05)
    view = np.array([[-1.0, -1.0], [1.0, 1.0]])
    given = given_scales(["temperature=250:1200"], ["temperature"])
    scale = colour_scale(frame, FIELDS[0], view, given)
    assert (scale.vmin, scale.vmax) == (250.0, 1200.0)
    with pytest.raises(InputError, match="LOW < HIGH"):
        given_scales(["temperature=nan:1"], ["temperature"])


def rows_by_key(title: str) -> Iterator[tuple[str, object]]:
    sections, _ = tables(inputs_text("a"))
    for section in sections:
        if section.title == title:
            yield from ((row.key, row) for row in section.rows)


def test_inputs_have_meaning_unit_and_workshop_unit() -> None:
    speed = dict(rows_by_key("Cut"))["speed"]
    assert (speed.value, speed.unit, speed.other) == ("3330", "mm/s", "199.8 m/min")  # type: ignore[attr-defined]
    assert speed.meaning == "Cutting speed"  # type: ignore[attr-defined]
    friction = dict(rows_by_key("Contact"))["friction.shear_limit"]
    assert (friction.value, friction.unit) == ("500", "MPa")  # type: ignore[attr-defined]
    assert list(dict(rows_by_key("Particle spacing"))) == ["tip_size"]


def test_material_constants_have_numbered_sources() -> None:
    _, (material,) = tables(inputs_text("a"))
    rows = {row.key: row for row in material.rows}
    cited = {
        key: material.references[int(row.source.strip("[]")) - 1] for key, row in rows.items() if row.source
    }
    assert cited["poisson_ratio"] == "the paper, Table 2"
    assert cited["A"].startswith("the paper, Table 2; Johnson and Cook 1983")
    assert cited["melting_temperature"] == "not given in the paper; Johnson and Cook 1983"
    assert cited["young_modulus"] == "given in place of the base's value"
    assert (rows["density"].other, rows["melting_temperature"].unit) == ("7844 kg/m³", "K")


@pytest.mark.parametrize(
    ("description", "unit", "words"),
    [
        ("Cutting speed (mm/s)", "mm/s", "Cutting speed"),
        ("Specific heat (mm²/(s² K)); a number", "mm²/(s² K)", "Specific heat; a number"),
        ("Density (tonne/mm³; steel has 7.8e-9)", "tonne/mm³", "Density (steel has 7.8e-9)"),
        ("Zone (a circle) of size (mm)", "mm", "Zone (a circle) of size"),
        ("No unit (at all", "", "No unit (at all"),
    ],
)
def test_units_are_read_from_descriptions(description: str, unit: str, words: str) -> None:
    assert unit_and_words(description) == (unit, words)


def test_values_in_workshop_units() -> None:
    assert converted(500.0, "mm/s") == "30 m/min"
    assert converted(0.025, "mm") == "25 µm"
    assert converted(2.5, "mm") == ""
    assert converted([293.15, 373.15], "K") == "20, 100 °C"
    assert converted(5.31e8, "mm²/(s² K)") == "531 J/(kg K)"
    assert converted(1e4, "N/(mm s K)") == "1e7 W/(m² K)"
    assert converted(True, "mm") == ""
    assert shown(4e7) == "4e7"
    assert (number(1000.0, 3), number(0.10412, 3), number(-2.02e8, 6)) == ("1000", "0.104", "-2.02e8")


@pytest.mark.parametrize(
    ("mean", "std", "text"),
    [
        (180.818, 0.316, ("180.82", "0.32")),
        (0.050031, 0.001455, ("0.0500", "0.0015")),
        (50803.46, 3735.4, ("50800", "3700")),
        (0.1067746, 0.0000001, ("0.10677", "1.0e-07")),
        (12.0, 0.0, ("12.00", "0")),
    ],
)
def test_a_mean_has_the_digits_of_its_scatter(mean: float, std: float, text: tuple[str, str]) -> None:
    assert with_scatter(mean, std) == text


def test_trend_is_the_change_of_the_fitted_line() -> None:
    travel = np.linspace(0.01, 1.0, 100)
    window = steady_window(travel, np.full(100, 100.0))
    assert trend(travel, 5.0 + 2.0 * travel, window) == pytest.approx(2.0 * (window.end - window.begin))


def test_ledgers_leave_what_the_history_says(run: Path) -> None:
    history = read_table(run / "history.csv")
    energy = energy_ledger(history, inertia=False)
    assert energy.left.share == f"{history['energy_error'][-1]:.2%}"
    assert [row.label for row in energy.outgo] == ["Plastic work", "Friction", "Elastic energy"]
    assert [row.label for row in energy.told] == ["Kinetic energy"]
    assert energy_ledger(history, inertia=True).left.share == "0.90%"
    heat = heat_ledger(history)
    assert (heat.left.value, [row.share for row in heat.outgo]) == ("0", ["77.78%", "22.22%"])


def test_a_general_case_and_an_unknown_key_have_tables_too() -> None:
    text = """
    problem = "general"
    [[body]]
    name = "block"
    velocity = [1.0, 0.0]
    later = 3.0
    [body.material]
    name = "steel"
    young_modulus = 2.0e5
    [[boundary]]
    part = "top"
    pressure = 10.0
    """
    sections, (material,) = tables(text)
    rows = {row.key: row for section in sections for row in section.rows}
    assert (rows["0.later"].value, rows["0.later"].meaning) == ("3", "")
    assert rows["0.velocity"].unit == "mm/s"
    assert rows["0.pressure"].unit == "MPa"
    assert material.title == "block: steel"


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
