"""The local page that follows a run, served by the standard library.

Whoever opens the page or the report needs the key in its address, which ``pfemcut watch`` prints; all other requests
carry it in a header that other pages can't send. So neither they nor other users of the machine can see the run or stop
it.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
import sys
import threading
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from numpy.typing import NDArray

from pfemcut.inputs import InputError, UserError
from pfemcut.output.directory import REPORT
from pfemcut.output.requests import Request, ask
from pfemcut.watch.picture import FIELD_NAMES, FieldPictures
from pfemcut.watch.state import COLUMNS, RunReader, RunState, Status
from pfemcut.whole_files import finite

Array = NDArray[np.float64]

KEY_HEADER = "X-Pfemcut-Key"
MOST_ROWS = 1500
"""Rows of the history in one answer; more are thinned."""

PLAIN = "text/plain; charset=utf-8"


class WatchServer(ThreadingHTTPServer):
    """Serves the page of one run.

    Parameters
    ----------
    reader
        Reads the run.
    host, port
        Where to listen; port 0 takes a free one.

    Raises
    ------
    InputError
        If it can't listen there.
    """

    daemon_threads = True

    def __init__(self, reader: RunReader, host: str, port: int) -> None:
        self.reader = reader
        self.key = secrets.token_urlsafe(16)
        self.pictures = FieldPictures(reader.directory)
        # One reader for all threads: it remembers how far it has read.
        self.reading = threading.Lock()
        if ":" in host:
            self.address_family = socket.AF_INET6
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError) as error:
            raise InputError(
                [f"can't listen on {host}, port {port}: {error}; give another --port"]
            ) from error

    @property
    def address(self) -> str:
        """The address of the page, with its key."""
        host, port = str(self.server_address[0]), self.server_address[1]
        shown = f"[{host}]" if ":" in host else host
        return f"http://{shown}:{port}/?key={self.key}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of browsers that left."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: WatchServer
    server_version = "pfemcut"
    sys_version = ""
    timeout = 30

    def do_GET(self) -> None:  # noqa: N802 (the library's name)
        """Answer with the page, the state, the history, a picture or the report."""
        try:
            parts = urlsplit(self.path)
        except ValueError:
            self._send(HTTPStatus.BAD_REQUEST, b"no such address", PLAIN)
            return
        query = {name: values[-1] for name, values in parse_qs(parts.query).items()}
        given = (
            query.get("key", "") if parts.path in ("/", "/report.html") else self.headers.get(KEY_HEADER, "")
        )
        if not self._has_key(given):
            return
        answers = {
            "/": self._page,
            "/state.json": self._state,
            "/history.json": self._history,
            "/field.png": self._field,
            "/report.html": self._report,
        }
        if parts.path not in answers:
            self._send(HTTPStatus.NOT_FOUND, b"no such page", PLAIN)
            return
        try:
            answers[parts.path](query)
        except UserError as error:
            self._send(HTTPStatus.CONFLICT, str(error).encode(), PLAIN)

    def do_POST(self) -> None:  # noqa: N802
        """Take a request to the run."""
        wishes = {"/checkpoint": Request.CHECKPOINT, "/stop": Request.STOP}
        path = self.path.partition("?")[0]
        origin, host = self.headers.get("Origin", ""), self.headers.get("Host", "")
        if origin and origin not in (f"http://{host}", f"https://{host}"):
            self._send(HTTPStatus.FORBIDDEN, b"asked by another page", PLAIN)
        elif not self._has_key(self.headers.get(KEY_HEADER, "")):
            return
        elif path not in wishes:
            self._send(HTTPStatus.NOT_FOUND, b"no such request", PLAIN)
        else:
            with self.server.reading:
                ended = self.server.reader.state().status is Status.ENDED
            if ended:
                self._send(HTTPStatus.CONFLICT, b"the run has ended", PLAIN)
                return
            try:
                ask(self.server.reader.directory, wishes[path])
            except UserError as error:
                self._send(HTTPStatus.CONFLICT, str(error).encode(), PLAIN)
                return
            self._send(HTTPStatus.ACCEPTED, b"asked", PLAIN)

    def _has_key(self, given: str) -> bool:
        """Whether the request carries the key; if not, it is answered so."""
        if hmac.compare_digest(given.encode(), self.server.key.encode()):
            return True
        self._send(HTTPStatus.FORBIDDEN, b"open the address that pfemcut watch printed, with its key", PLAIN)
        return False

    def _page(self, _: Mapping[str, str]) -> None:
        nonce = secrets.token_urlsafe(12)
        environment = Environment(
            loader=FileSystemLoader(Path(__file__).parent / "templates"),
            autoescape=True,
            undefined=StrictUndefined,
        )
        page = environment.get_template("watch.html.j2").render(
            title=self.server.reader.title,
            directory=str(self.server.reader.directory),
            key=self.server.key,
            nonce=nonce,
            fields=FIELD_NAMES,
        )
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src blob:; "
            "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        self._send(HTTPStatus.OK, page.encode(), "text/html; charset=utf-8", policy)

    def _state(self, _: Mapping[str, str]) -> None:
        with self.server.reading:
            state = self.server.reader.state()
        report = (self.server.reader.directory / REPORT).is_file()
        self._json({**state_json(state), "report": report})

    def _history(self, query: Mapping[str, str]) -> None:
        with self.server.reading:
            history = self.server.reader.history()
        try:
            after = float(query.get("after", "-1"))
        except ValueError:
            after = -1.0
        self._json(history_json(history, after))

    def _field(self, query: Mapping[str, str]) -> None:
        name = query.get("name", FIELD_NAMES[0][0])
        if name not in dict(FIELD_NAMES):
            self._send(HTTPStatus.NOT_FOUND, b"no such field", PLAIN)
            return
        self._send(HTTPStatus.OK, self.server.pictures.png(name), "image/png")

    def _report(self, _: Mapping[str, str]) -> None:
        try:
            content = (self.server.reader.directory / REPORT).read_bytes()
        except OSError:
            self._send(HTTPStatus.NOT_FOUND, b"there is no report yet", PLAIN)
            return
        policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; frame-ancestors 'none'"
        self._send(HTTPStatus.OK, content, "text/html; charset=utf-8", policy)

    def _json(self, content: Mapping[str, Any]) -> None:
        text = json.dumps(content, allow_nan=False)
        self._send(HTTPStatus.OK, text.encode(), "application/json")

    def _send(self, code: HTTPStatus, content: bytes, kind: str, policy: str = "default-src 'none'") -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Content-Security-Policy", policy)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 (the library's name)
        """Keep the terminal quiet."""


def state_json(state: RunState) -> dict[str, Any]:
    """Return a state as JSON knows it: null for nan."""
    return {
        "title": state.title,
        "status": state.status.value,
        "words": state.words,
        "share": finite(state.share),
        "to_go": finite(state.to_go),
        "latest": {name: finite(value) for name, value in state.latest.items()},
        "travel_end": finite(state.travel_end),
        "frame": state.frame,
        "checkpoint_age": finite(state.checkpoint_age),
        "requests": list(state.requests),
        "warnings": list(state.warnings),
    }


def history_json(history: Mapping[str, Array], after: float) -> dict[str, Any]:
    """Return the rows after a step, thinned if they are many; the last one is always among them."""
    rows = np.flatnonzero(history.get("step", np.zeros(0)) > after)
    if rows.size > MOST_ROWS:
        rows = rows[np.unique(np.linspace(0, rows.size - 1, MOST_ROWS).round().astype(int))]
    return {
        "columns": {
            name: [finite(value) for value in history[name][rows].tolist()]
            for name in COLUMNS
            if name in history
        }
    }
