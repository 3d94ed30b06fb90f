"""Options and exit statuses that demo and study scripts share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from pfemcut.inputs import UserError
from pfemcut.launcher import speaks
from pfemcut.method import RunStopped
from pfemcut.ranks import Ranks
from pfemcut.validation.recorded_run import Start


def parser(description: str, output: Path) -> argparse.ArgumentParser:
    """Parser of ``-o``, ``--resume``, ``--overwrite`` and ``--travel``."""
    options = argparse.ArgumentParser(description=description)
    options.add_argument(
        "-o",
        "--output",
        type=Path,
        default=output,
        metavar="DIR",
        help="folder of the run (default: %(default)s)",
    )
    options.add_argument(
        "--resume", action="store_true", help="go on from the last checkpoint, if there is one"
    )
    options.add_argument(
        "--overwrite", action="store_true", help="replace the results of an earlier run in DIR"
    )
    options.add_argument(
        "--travel",
        type=float,
        metavar="MM",
        help="another travel, for trying: results then go to DIR/results instead of the demo's",
    )
    return options


def start_of(arguments: argparse.Namespace) -> Start:
    """How the runs start."""
    if arguments.resume and arguments.overwrite:
        raise UserError("--resume and --overwrite exclude each other")
    return Start(arguments.resume, arguments.overwrite)


def exit_with(work: Callable[[Sequence[str]], bool], arguments: Sequence[str] | None = None) -> None:
    """Exit with 0 if ``work`` says that all is well, 1 if not or if a run stopped, 2 for bad input."""
    try:
        with Ranks().together():
            status = 0 if work(sys.argv[1:] if arguments is None else arguments) else 1
    except UserError as error:
        status = _complain(str(error), 2)
    except RunStopped as error:
        status = _complain(f"run stopped: {error}", 1)
    except KeyboardInterrupt:
        status = _complain("interrupted", 130)
    sys.exit(status)


def _complain(text: str, status: int) -> int:
    if speaks():
        print("\n".join(f"{Path(sys.argv[0]).name}: {line}" for line in text.splitlines()), file=sys.stderr)
    return status
