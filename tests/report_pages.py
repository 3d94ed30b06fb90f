"""An output directory for reports, and their pages as a browser reads them."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
from synthetic_cut import filled_frame

from pfemcut.case.load import resolved_toml, validated
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.history import TableWriter, read_table
from pfemcut.results.summary import summarise, write_summary

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
