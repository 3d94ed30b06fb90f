"""Reads ``summary.json`` back, and says what is wrong with a damaged one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pfemcut.inputs import UserError

_TEXTS = ("title", "ending")
_TABLES = ("ledgers", "seconds_per_step", "versions")
_FIGURES = ("steady", "steps", "wall_time")
NEEDED = ("finished", "ending", "warnings", "steady", "steps", "wall_time", "window", "travel")
"""What the summaries of all runs have."""


class SummaryError(UserError):
    """A ``summary.json`` that can't be used; the message says why."""


def read_summary_file(path: Path) -> dict[str, Any]:
    """Content of a ``summary.json``, whose entries have the kinds that a run writes; not all need to be there.

    Raises
    ------
    SummaryError
        If it can't be read, or is damaged.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SummaryError(f"{path}: can't be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise SummaryError(f"{path}: damaged: {error}") from error
    if not isinstance(content, dict):
        raise SummaryError(f"{path}: damaged: is not a summary")
    wrong = [name for name, value in content.items() if not _as_written(name, value)]
    if wrong:
        raise SummaryError(f"{path}: damaged: no run writes such a '{wrong[0]}'")
    return content


def required(content: Mapping[str, Any], path: Path, *names: str) -> None:
    """Raise :class:`SummaryError` unless the content of the summary at ``path`` has all of ``names``."""
    missing = [
        name for name in names if name not in content or (name in _FIGURES and not _is_figure(content[name]))
    ]
    if missing:
        raise SummaryError(f"{path}: damaged: has no '{missing[0]}' as a run writes it")


def _as_written(name: str, value: Any) -> bool:
    if name in _TEXTS:
        return isinstance(value, str)
    if name == "finished":
        return isinstance(value, bool)
    if name == "travel":
        return _is_number(value)
    if name == "warnings":
        return isinstance(value, list) and all(isinstance(text, str) for text in value)
    if name == "window":
        return isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))
    if name == "versions":
        return isinstance(value, dict) and all(isinstance(each, str) for each in value.values())
    if name in _TABLES:
        return isinstance(value, dict) and all(map(_is_number, value.values()))
    # Figures have a unit; anything else is what a later version, or a study, writes besides.
    return not isinstance(value, dict) or "unit" not in value or _is_figure(value)


def _is_figure(value: Any) -> bool:
    if not isinstance(value, dict) or not isinstance(value.get("unit"), str):
        return False
    numbers = [each for key, each in value.items() if key != "unit"]
    return bool(numbers) and ("value" in value or "mean" in value) and all(map(_is_number, numbers))


def _is_number(value: Any) -> bool:
    # True and false, such as of steady, are numbers to Python.
    return isinstance(value, int | float) and abs(value) < 1e300
