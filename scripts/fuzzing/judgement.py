"""What comes of an input: accepted, refused in clear words, or a defect."""

from __future__ import annotations

import signal
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any

from pfemcut.inputs import UserError

LONGEST_MESSAGE = 2000
"""Characters of a line."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise ``TooSlow`` in the block after ``seconds`` of processor time."""

    def ring(_: int, frame: FrameType | None) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


class TooSlow(BaseException):
    """An input that takes longer than it may."""


class Changed(Exception):
    """An accepted value that is not the given one."""


def require_same_values(given: Any, resolved: Any, path: str = "") -> None:
    """Raise :class:`Changed` unless every given value stands in the resolved case.

    Materials and wear constants that are given by name, or on top of a base, are written out there.
    """
    if isinstance(given, Mapping) and isinstance(resolved, Mapping):
        if "base" in given:
            given = {key: value for key, value in given.items() if key != "base"}
        for key, value in given.items():
            if key in ("material", "wear", "base") and isinstance(value, str):
                continue
            if key not in resolved:
                raise Changed(f"{path}.{key}: lost")
            require_same_values(value, resolved[key], f"{path}.{key}")
    elif isinstance(given, list) and isinstance(resolved, list):
        if len(given) != len(resolved):
            raise Changed(f"{path}: {len(given)} -> {len(resolved)} entries")
        for index, (one, other) in enumerate(zip(given, resolved, strict=True)):
            require_same_values(one, other, f"{path}[{index}]")
    elif given != resolved:
        # A property that is constant is written as a number.
        if isinstance(given, Mapping) and len(given.get("value", ())) == 1 and given["value"][0] == resolved:
            return
        raise Changed(f"{path}: {str(given)[:60]} -> {str(resolved)[:60]}")


def judged(read: Callable[[], object], limit: float) -> tuple[str, str]:
    """What comes of reading an input within ``limit`` seconds of processor time, and its details."""
    try:
        with limited(limit), warnings.catch_warnings():
            warnings.simplefilter("error")
            read()
    except UserError as error:
        lines = str(error).splitlines()
        if not lines or not all(line.strip() for line in lines) or max(map(len, lines)) > LONGEST_MESSAGE:
            return "defect: unclear message", str(error)[:300]
        return "refused", str(error)
    except TooSlow:
        return "defect: too slow", traceback.format_exc(limit=-6)
    except Changed as error:
        return "defect: changed", str(error)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"defect: {type(error).__name__}", traceback.format_exc(limit=-6)
    return "accepted", ""
