"""Mesh files, summaries, tables and frames that are cut short or changed are refused in one clear line."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from synthetic_cut import filled_frame

from meshing.initial import MeshFileError, read_mesh
from pfemcut.output.vtu import FieldsError, FieldWriter, read_last_frame
from pfemcut.results.history import HistoryError, read_table
from pfemcut.results.summary_file import NEEDED, SummaryError, read_summary_file, required
from pfemcut.validation.recorded_run import sessions

ROOT = Path(__file__).parents[1]
SQUARE = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0.0 0.0 0.0
2 1.0 0.0 0.0
3 1.0 1.0 0.0
4 0.0 1.0 0.0
5 0.5 0.5 0.0
$EndNodes
$Elements
4
1 2 2 3 3 1 2 5
2 2 2 3 3 2 3 5
3 2 2 3 3 3 4 5
4 2 2 3 3 4 1 5
$EndElements
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("4 1 5\n$End", "4 1 9\n$End", "a triangle has a node that is not there|out of bounds"),
        ("5 0.5 0.5", "5 nan 0.5", "lies beyond 1e\\+06 mm, or nowhere"),
        ("5 0.5 0.5", "5 1e9 0.5", "lies beyond"),
        ("5 0.5 0.5", "5 0.5 0.0", "a triangle has no area"),
        ("3 2 2 3 3 3 4 5", "3 2 2 3 3 2 3 5", "triangles overlap"),
        ("$Elements", "$Elephants", "not a mesh that meshio can read|holds no triangles"),
        ("2.2 0 8", "7 0 8", "not a mesh that meshio can read"),
        (SQUARE[40:], "", "not a mesh that meshio can read|holds no triangles"),
    ],
)
def test_a_damaged_mesh_file_is_one_clear_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], old: str, new: str, words: str
) -> None:
    path = tmp_path / "square.msh"
    path.write_text(SQUARE)
    mesh, _ = read_mesh(path)
    assert mesh.cells.shape == (4, 3)
    assert old in SQUARE
    path.write_text(SQUARE.replace(old, new))
    with pytest.raises(MeshFileError, match=words) as refused:
        read_mesh(path)
    assert len(str(refused.value).splitlines()) == 1
    # meshio's own words would come on top.
    assert "".join(capfd.readouterr()).strip() == ""


WHOLE = {
    "cutting_force": {"mean": 1.0, "std": 0.1, "unit": "N/mm"},
    "steady": {"value": True, "unit": "-"},
    "warnings": [],
    "window": [0.0, 1.0],
    "ledgers": {"tool_work": 1.0},
    "finished": True,
}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "damaged: Expecting value"),
        ("[" * 5000, "damaged"),
        ("[1]", "is not a summary"),
        (json.dumps({**WHOLE, "cutting_force": {"mean": "much", "unit": "N/mm"}}), "such a 'cutting_force'"),
        (json.dumps({**WHOLE, "cutting_force": {"unit": "N/mm"}}), "such a 'cutting_force'"),
        (json.dumps({**WHOLE, "cutting_force": {"std": 1.0, "unit": "N/mm"}}), "such a 'cutting_force'"),
        (json.dumps({**WHOLE, "warnings": "none"}), "such a 'warnings'"),
        (json.dumps({**WHOLE, "window": [0.0]}), "such a 'window'"),
        (json.dumps({**WHOLE, "window": [0.0, float("inf")]}), "such a 'window'"),
        (json.dumps({**WHOLE, "finished": None}), "such a 'finished'"),
        (json.dumps({**WHOLE, "ledgers": {"tool_work": None}}), "such a 'ledgers'"),
    ],
)
def test_a_damaged_summary_is_one_clear_line(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "summary.json"
    path.write_text(json.dumps(WHOLE))
    assert read_summary_file(path) == WHOLE
    path.write_text(text)
    with pytest.raises(SummaryError, match=re.escape(words)):
        read_summary_file(path)


def test_summaries_that_were_recorded_are_whole() -> None:
    """That of the long cut is of several sessions, and has no figures."""
    paths = sorted(ROOT.glob("demos/*/results/summary.json"))
    assert len(paths) > 3
    for path in paths:
        content = read_summary_file(path)
        if path.parts[-3] != "aisi4340_long":
            required(content, path, *NEEDED)
    with pytest.raises(SummaryError, match="has no 'steady' as a run writes it"):
        required({**WHOLE, "steady": True}, ROOT, "finished", "steady")


def test_damaged_tables_and_sessions_are_one_clear_line(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    for content, words in (
        (b"step,travel\n1,0.\xff\n", "can't be read"),
        (b"step,step\n1,1\n", "a column is there twice"),
        (b"step,travel\n1\n", "has not 2 values"),
    ):
        path.write_bytes(content)
        with pytest.raises(HistoryError, match=words):
            read_table(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(HistoryError, match="can't be read"):
        read_table(path)
    (tmp_path / "sessions.json").write_text("{}")
    with pytest.raises(SummaryError, match="is no list of sessions"):
        sessions(tmp_path)


def test_damaged_frames_are_one_clear_line(tmp_path: Path) -> None:
    frame = replace(filled_frame(6.0, 0.15, spacing=0.1), step=3)
    FieldWriter(tmp_path).write(frame)
    body, tool = sorted((tmp_path / "fields").glob("*.vtu"))
    whole = body.read_bytes()
    for content in (
        b"",
        whole[: len(whole) // 2],
        tool.read_bytes(),
        whole.replace(b"in_contact", b"in_context"),
    ):
        body.write_bytes(content)
        with pytest.raises(FieldsError) as refused:
            read_last_frame(tmp_path)
        assert len(str(refused.value)) < 600
    (tmp_path / "fields.pvd").unlink()
    (tmp_path / "fields.pvd").mkdir()
    with pytest.raises(FieldsError, match="damaged"):
        read_last_frame(tmp_path)
