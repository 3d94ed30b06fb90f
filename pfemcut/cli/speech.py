"""Lines for the user; under mpirun only rank 0 speaks."""

from __future__ import annotations

import sys

from pfemcut.launcher import speaks


def say(line: str) -> None:
    """Print a line."""
    if speaks():
        print(line, flush=True)


def complain(*lines: str) -> None:
    """Print lines of an error."""
    if speaks():
        for line in lines:
            print(f"pfemcut: {line}", file=sys.stderr)
