"""``pfemcut watch``: its options, and requests to a run."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from pfemcut.cli.speech import say
from pfemcut.inputs import InputError

LOOPBACK = ("127.0.0.1", "::1", "localhost")


def watch(
    directory: Annotated[
        Path, typer.Argument(metavar="DIR", help="Output folder of a run.", show_default=False)
    ],
    terminal: Annotated[bool, typer.Option("--terminal", help="Show the run here, not on a page.")] = False,
    checkpoint: Annotated[
        bool, typer.Option("--checkpoint", help="Ask the run for a checkpoint, and return.")
    ] = False,
    stop: Annotated[
        bool, typer.Option("--stop", help="Ask the run to stop with a checkpoint, and return.")
    ] = False,
    host: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="Where to listen; others than the default open the page to a network."
        ),
    ] = LOOPBACK[0],
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Port of the page; 0 for a free one.")
    ] = 8765,
    every: Annotated[
        float, typer.Option(metavar="SECONDS", min=0.1, help="Time between two looks with --terminal.")
    ] = 2.0,
) -> None:
    """Follow a run, and ask it for a checkpoint or to stop."""
    if sum((terminal, checkpoint, stop)) > 1:
        raise InputError(["--terminal, --checkpoint and --stop exclude each other"])
    from pfemcut.watch.state import RunReader, Status

    reader = RunReader(directory)
    if checkpoint or stop:
        from pfemcut.output.requests import Request, ask

        state = reader.state()
        if state.status is Status.ENDED:
            raise InputError([f"{directory}: the run has ended ({state.words})"])
        ask(directory, Request.STOP if stop else Request.CHECKPOINT)
        say(f"asked to {'stop' if stop else 'write a checkpoint'} after the present step")
        return
    if terminal:
        from rich.console import Console

        from pfemcut.watch.terminal import follow

        # Leaving the view leaves the run alone.
        with contextlib.suppress(KeyboardInterrupt):
            follow(reader, Console(), every)
        return
    from pfemcut.watch.server import WatchServer

    with WatchServer(reader, host, port) as server:
        if host not in LOOPBACK:
            say(
                "warning: not encrypted; whoever has the key and can reach this address can see and stop the run"
            )
        say(f"{server.address}  (Ctrl-C ends the view, not the run)")
        with contextlib.suppress(KeyboardInterrupt):
            server.serve_forever()
