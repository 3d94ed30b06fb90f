"""Following a run: requests that it obeys, the page that is served, and who may ask."""

from __future__ import annotations

import http.client
import json
import os
import re
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from launch import TESTS, mpirun
from rich.console import Console
from synthetic_cut import filled_frame
from test_driver import frames_in, run, summary_in

from pfemcut.cli.main import status
from pfemcut.driver import RunInterrupted
from pfemcut.inputs import InputError
from pfemcut.output.requests import Request, ask, asked
from pfemcut.output.vtu import FieldWriter, read_collection
from pfemcut.results.checkpoint import read_checkpoint
from pfemcut.results.history import HistoryError, read_table
from pfemcut.watch.picture import FieldPictures
from pfemcut.watch.server import KEY_HEADER, WatchServer, history_json
from pfemcut.watch.state import RunReader, Status
from pfemcut.watch.tail import TableTail
from pfemcut.watch.terminal import follow, sparkline

INPUTS = """title = "<b>a</b> [red]"
[cutting]
speed = 1.0
travel = 2.0
depth = 0.1
[tool]
rake = 6.0
clearance = 5.0
tip_radius = 0.025
"""


@pytest.fixture
def going(tmp_path: Path) -> Path:
    """The directory of a run that is in the middle of its way."""

    def leave() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run(tmp_path, last=40, events={21: leave}, inputs=INPUTS)
    return tmp_path


@pytest.fixture
def server(going: Path) -> Iterator[WatchServer]:
    with WatchServer(RunReader(going), "127.0.0.1", 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()


def answer(
    server: WatchServer, path: str, method: str = "GET", headers: dict[str, str] | None = None
) -> tuple[int, bytes, http.client.HTTPMessage]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=20)
    connection.request(method, path, headers={KEY_HEADER: server.key} if headers is None else headers)
    reply = connection.getresponse()
    return reply.status, reply.read(), reply.headers


# The run obeys.


def test_a_checkpoint_is_written_when_asked_and_the_run_goes_on(tmp_path: Path) -> None:
    seen: list[tuple[int, tuple[Request, ...]]] = []

    def look() -> None:
        seen.append((read_checkpoint(tmp_path).step, asked(tmp_path)))

    events = {7: lambda: ask(tmp_path, Request.CHECKPOINT), 8: look}
    summary = run(tmp_path, last=9, events=events)
    assert seen == [(7, ())]
    assert (summary.finished, summary.steps) == (True, 9)


def test_a_stop_is_obeyed_and_the_run_can_be_resumed(tmp_path: Path) -> None:
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run(whole, last=20)
    with pytest.raises(RunInterrupted, match="stopped by a request after step 7, .*can be resumed"):
        run(stopped, last=20, events={7: lambda: ask(stopped, Request.STOP)})
    assert summary_in(stopped)["finished"] is False
    assert (read_checkpoint(stopped).step, asked(stopped), frames_in(stopped)[-1]) == (7, (), 7)
    run(stopped, last=20, resume=True)
    assert (stopped / "history.csv").read_bytes() == (whole / "history.csv").read_bytes()


def test_two_ranks_obey_a_request_together(tmp_path: Path) -> None:
    ended = mpirun(TESTS / "rank_worker.py", "request to stop", tmp_path / "stopped")
    assert ended.returncode == 1
    assert "stopped by a request after step 7" in summary_in(tmp_path / "stopped")["ending"]
    run(tmp_path / "stopped", resume=True)
    run(tmp_path / "whole")
    whole, resumed = ((tmp_path / name / "history.csv").read_bytes() for name in ("whole", "stopped"))
    assert resumed == whole


def test_a_request_to_an_earlier_run_is_forgotten(tmp_path: Path) -> None:
    ask(tmp_path, Request.STOP)
    assert run(tmp_path, last=5).finished
    assert asked(tmp_path) == ()


def test_a_stop_after_the_last_step_is_too_late(tmp_path: Path) -> None:
    assert run(tmp_path, last=5, events={5: lambda: ask(tmp_path, Request.STOP)}).finished


def test_the_command_asks_and_says_when_it_is_too_late(
    going: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(["watch", str(going), "--checkpoint"]) == 0
    assert status(["watch", str(going), "--stop"]) == 0
    assert asked(going) == (Request.CHECKPOINT, Request.STOP)
    run(going, last=40, resume=True, inputs=INPUTS)
    assert status(["watch", str(going), "--stop"]) == 2
    assert "the run has ended (finished: reached its final time)" in capsys.readouterr().err
    assert status(["watch", str(going), "--stop", "--terminal"]) == 2


# What is read.


def test_state_of_a_run_that_goes_on(going: Path) -> None:
    state = RunReader(going).state()
    assert (state.status, state.title) == (Status.RUNNING, "<b>a</b> [red]")
    assert state.share == pytest.approx(0.5)
    assert (state.latest["step"], state.travel_end, state.frame) == (20.0, 2.0, 20)
    # 20 of 40 steps are done: as long to go as they took, give or take their scatter.
    total = read_table(going / "timing.csv")["total"]
    assert 0.5 * total.sum() < state.to_go < 2.0 * total.sum()
    assert state.checkpoint_age < 60.0


def test_a_run_without_a_sign_of_life_is_silent(going: Path) -> None:
    later = time.time() + 100.0
    state = RunReader(going, clock=lambda: later).state()
    assert state.status is Status.SILENT
    assert re.search(r"no step for (99|100|101) s", state.words)


def test_a_run_that_ended_says_how(tmp_path: Path) -> None:
    run(tmp_path, last=5, inputs=INPUTS)
    reader = RunReader(tmp_path)
    state = reader.state()
    assert (state.status, state.words) == (Status.ENDED, "finished: reached its final time")
    assert any("not steady" in text for text in state.warnings)
    # The history goes on: the summary was that of a report in between.
    later = (tmp_path / "summary.json").stat().st_mtime + 10.0
    os.utime(tmp_path / "history.csv", (later, later))
    assert reader.state().status is not Status.ENDED


def test_a_directory_without_a_run_is_one_clear_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(["watch", str(tmp_path), "--port", "0"]) == 2
    assert capsys.readouterr().err == f"pfemcut: {tmp_path}: no run here (inputs.resolved.toml is missing)\n"
    assert status(["watch", str(tmp_path / "nowhere"), "--terminal"]) == 2
    (tmp_path / "inputs.resolved.toml").write_text("[")
    with pytest.raises(InputError, match="can't be read"):
        RunReader(tmp_path)


def test_a_table_is_read_piece_by_piece_and_anew_when_cut_short(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    tail = TableTail(path, ("step", "x", "missing"))
    tail.update()
    assert tail.columns() == {}
    path.write_text("step,y,x\n1,0,10\n2,0,20\n3,0")
    tail.update()
    assert tail.columns()["x"].tolist() == [10.0, 20.0]
    with path.open("a") as file:
        file.write(",30\n4,0,nan\n")
    tail.update()
    assert tail.columns()["step"].tolist() == [1.0, 2.0, 3.0, 4.0]
    path.write_text("step,y,x\n1,0,10\n2,0,21\n3,0,31\n4,0,41\n5,0,51\n")
    tail.update()
    assert tail.columns()["x"].tolist() == [10.0, 21.0, 31.0, 41.0, 51.0]
    path.write_text("step,y,x\n1,0,what\n")
    with pytest.raises(HistoryError, match="damaged"):
        tail.update()


def test_history_is_json_without_nan_thinned_and_from_a_step_on() -> None:
    steps = np.arange(1.0, 10001.0)
    history = {"step": steps, "travel": steps * 1e-4, "cutting_force": np.where(steps == 10000, np.nan, 7.0)}
    columns = history_json(history, -1.0)["columns"]
    assert len(columns["step"]) <= 1500
    assert (columns["step"][0], columns["step"][-1], columns["cutting_force"][-1]) == (1.0, 10000.0, None)
    assert history_json(history, 9998.0)["columns"]["step"] == [9999.0, 10000.0]
    assert history_json({}, -1.0) == {"columns": {}}


# What is served.


def test_the_page_escapes_and_runs_its_own_script_only(server: WatchServer) -> None:
    code, body, headers = answer(server, f"/?key={server.key}", headers={})
    page = body.decode()
    assert code == 200
    assert "&lt;b&gt;a&lt;/b&gt;" in page
    assert "<b>a</b>" not in page
    nonce = re.search(r"script-src 'nonce-([^']+)'", headers["Content-Security-Policy"])
    assert nonce is not None
    assert re.findall(r"<script[^>]*>", page) == [f'<script nonce="{nonce[1]}">']
    assert "http://" not in page.replace("http://www.w3.org/2000/svg", "")
    assert "https://" not in page


def test_state_history_and_picture_are_served(server: WatchServer) -> None:
    code, body, _ = answer(server, "/state.json")
    state = json.loads(body)
    assert (code, state["status"], state["latest"]["step"], state["report"]) == (200, "running", 20.0, False)
    code, body, _ = answer(server, "/history.json?after=17")
    assert json.loads(body)["columns"]["step"] == [18.0, 19.0, 20.0]
    code, body, _ = answer(server, "/field.png")
    assert (code, body) == (409, b"the last frame has no elements to draw")
    FieldWriter(server.reader.directory, 20).write(replace(filled_frame(6.0, 0.15, spacing=0.05), step=21))
    code, body, headers = answer(server, "/field.png?name=temperature")
    assert (code, headers["Content-Type"], body[:4]) == (200, "image/png", b"\x89PNG")


def test_a_picture_is_drawn_anew_when_the_same_step_is_written_again(going: Path) -> None:
    """As by a run that was started again; within a tick of the clock of the file system."""
    frame = replace(filled_frame(6.0, 0.15, spacing=0.05), step=21)
    FieldWriter(going, 20).write(frame)
    pictures = FieldPictures(going)
    first = pictures.png("temperature")
    assert pictures.png("temperature") is first
    files = [going / entry.file for entry in read_collection(going) if entry.step == 21]
    written = [path.stat() for path in files]
    hotter = frame.point_fields["temperature"] + 100.0 * frame.points[:, 1]
    FieldWriter(going, 20).write(replace(frame, point_fields={**frame.point_fields, "temperature": hotter}))
    for path, before in zip(files, written, strict=True):
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert pictures.png("temperature") != first


def test_requests_of_the_page_reach_the_directory(server: WatchServer) -> None:
    directory = server.reader.directory
    assert answer(server, "/checkpoint", "POST")[0] == 202
    assert asked(directory) == (Request.CHECKPOINT,)
    assert json.loads(answer(server, "/state.json")[1])["requests"] == ["checkpoint"]
    assert answer(server, "/stop", "POST")[0] == 202
    assert asked(directory) == (Request.CHECKPOINT, Request.STOP)
    assert answer(server, "/explode", "POST")[0] == 404


def test_without_the_key_nothing_is_told_and_nothing_asked(server: WatchServer) -> None:
    for path in (
        "/",
        "/?key=wrong",
        "/state.json",
        f"/state.json?key={server.key}",
        "/history.json",
        "/report.html",
    ):
        assert answer(server, path, headers={})[0] == 403
    assert answer(server, "/stop", "POST", headers={})[0] == 403
    assert answer(server, f"/stop?key={server.key}", "POST", headers={})[0] == 403
    assert answer(server, "/stop", "POST", headers={KEY_HEADER: "é"})[0] == 403
    assert asked(server.reader.directory) == ()


def test_another_page_cannot_ask_even_with_the_key(server: WatchServer) -> None:
    headers = {KEY_HEADER: server.key, "Origin": "http://evil.example"}
    assert answer(server, "/stop", "POST", headers=headers)[0] == 403
    assert asked(server.reader.directory) == ()
    own = {KEY_HEADER: server.key, "Origin": f"http://127.0.0.1:{server.server_address[1]}"}
    assert answer(server, "/stop", "POST", headers=own)[0] == 202


@pytest.mark.parametrize(
    "path",
    [
        "/../history.csv",
        "/history.csv",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/fields/../checkpoint.h5",
        "/field.png?name=../../etc/passwd",
        "/field.png?name=%00",
    ],
)
def test_no_path_leads_to_other_files(server: WatchServer, path: str) -> None:
    assert answer(server, path)[0] == 404


def test_an_ended_run_is_not_asked_any_more(server: WatchServer) -> None:
    run(server.reader.directory, last=40, resume=True, inputs=INPUTS)
    assert answer(server, "/stop", "POST")[0] == 409
    assert asked(server.reader.directory) == ()
    assert answer(server, f"/report.html?key={server.key}", headers={})[0] == 404


def test_a_port_in_use_is_one_clear_error(server: WatchServer) -> None:
    with pytest.raises(InputError, match="can't listen on 127.0.0.1, port .*give another --port"):
        WatchServer(server.reader, "127.0.0.1", server.server_address[1])


def test_it_listens_on_loopback_unless_told_otherwise(
    going: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(WatchServer, "serve_forever", lambda self: None)
    assert status(["watch", str(going), "--port", "0"]) == 0
    told = capsys.readouterr().out
    assert re.match(r"http://127\.0\.0\.1:\d+/\?key=\S{20,}  ", told)
    assert "warning" not in told
    assert status(["watch", str(going), "--port", "0", "--host", "0.0.0.0"]) == 0
    assert "warning: not encrypted" in capsys.readouterr().out


# The terminal.


def test_the_terminal_follows_until_the_end(going: Path) -> None:
    console = Console(record=True, width=110, force_terminal=True)
    follow(
        RunReader(going),
        console,
        0.0,
        sleep=lambda _: run(going, last=40, resume=True, inputs=INPUTS) and None,
    )
    shown = console.export_text()
    assert "finished: reached its final time; travel 2.0000 of 2 mm, step 40" in shown
    assert "<b>a</b> [red]" in shown
    assert "Fc" in shown


def test_without_a_terminal_there_are_plain_lines(going: Path) -> None:
    console = Console(record=True, width=200)
    follow(
        RunReader(going),
        console,
        0.0,
        sleep=lambda _: run(going, last=40, resume=True, inputs=INPUTS) and None,
    )
    first, *_, last = console.export_text().splitlines()
    assert first.startswith("running; travel 1.0000 of 2 mm, step 20  Fc ")
    assert last.startswith("finished: reached its final time; travel 2.0000")


def test_a_sparkline_rises_with_its_values() -> None:
    along = np.arange(100.0)
    assert sparkline(along, along, 8) == "▁▂▃▄▅▆▇█"
    assert sparkline(np.full(3, np.nan), np.arange(3.0)) == ""
