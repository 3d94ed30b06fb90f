"""User input and its errors: one clear line a problem, naming the key, what was given and what is allowed."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError


class UserError(Exception):
    """Something that the user can mend; the message says what, in one line a problem. Exit status 2."""


class InputError(UserError):
    """Bad user input; ``problems`` holds one line each and the message is all of them."""

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(self.problems)


def nearest(name: str, candidates: Iterable[str]) -> str:
    """Hint ``; did you mean 'candidate'?`` at the most similar candidate, else the list of all candidates."""
    known = list(candidates)
    lowered = {candidate.lower(): candidate for candidate in known}
    close = difflib.get_close_matches(name.lower(), lowered, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{lowered[close[0]]}'?"
    return "; allowed: " + ", ".join(f"'{candidate}'" for candidate in known)


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file.

    Raises
    ------
    InputError
        If the file is missing, is a directory, is unreadable, is not UTF-8 or has a syntax error (named with
        its line).
    """
    if path.is_dir():
        raise InputError([f"{path}: is a directory, not a TOML file"])
    try:
        text = path.read_bytes().decode("utf-8")
    except FileNotFoundError:
        raise InputError([f"{path}: no such file"]) from None
    except UnicodeDecodeError as error:
        raise InputError([f"{path}: not UTF-8 text (byte {error.start})"]) from None
    except OSError as error:
        raise InputError([f"{path}: can't be read: {error.strerror}"]) from None
    try:
        # An editor's byte order mark is not part of the document.
        return tomllib.loads(text.removeprefix("\ufeff"))
    except tomllib.TOMLDecodeError as error:
        raise InputError([f"{path}: TOML syntax error: {error}"]) from None


class NoQuantity(str):
    """Text in the place of a number that is none with a suitable unit; ``problem`` says why."""

    def __new__(cls, text: str, problem: str) -> NoQuantity:
        """``text`` with its ``problem``."""
        made = super().__new__(cls, text)
        made.problem = problem
        return made

    problem: str


def explained(error: ValidationError, model: type[BaseModel], section: str = "") -> list[str]:
    """One line for each problem of a failed validation.

    Parameters
    ----------
    error
        What pydantic raised.
    model
        The model that was validated; descriptions and known keys come from it.
    section
        TOML path of the table that was validated; empty for a whole file.
    """
    lines = [line for item in error.errors() for line in _lines(dict(item), model, section)]
    return list(dict.fromkeys(lines))


def description_of(model: type[BaseModel], loc: Sequence[int | str]) -> str:
    """What the schema says of the key at ``loc``; nothing if it knows no such key."""
    path, _, _, description = _resolve(loc, model, False)
    return description if len(path) == len(loc) else ""


def _lines(item: dict[str, Any], model: type[BaseModel], section: str) -> list[str]:
    path, models, is_table, description = _resolve(item["loc"], model, item["type"] == "extra_forbidden")
    kind, context = item["type"], item.get("ctx", {})
    label = _label(section, path)
    if kind == "extra_forbidden":
        known = dict.fromkeys(name for candidate in models for name in candidate.model_fields)
        return [f"{label}: unknown key{nearest(str(path[-1]), known)}"]
    if kind == "value_error":
        # Raised by our own validators, which word the whole problem; several are one a line.
        messages = str(context["error"]).splitlines()
        if path and not is_table:
            return [f"{label}: {message}" for message in messages]
        place = ".".join(key for key in (section, *map(str, path)) if key)
        return [f"[{place}] {message}" if place else message for message in messages]
    note = f": {description}" if description else ""
    if isinstance(item["input"], NoQuantity):
        # The description says what else than a quantity is allowed.
        return [f"{label}: {item['input'].problem}{note if is_table else ''}"]
    if kind == "union_tag_not_found" and context["discriminator"].startswith("'"):
        key = context["discriminator"].strip("'")
        return [f"{_label(section, [*path, key])}: missing and has no default"]
    if kind in ("missing", "union_tag_not_found"):
        return [f"{label}: missing and has no default{note}"]
    if kind == "union_tag_invalid":
        tags = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        discriminator = context["discriminator"].strip("'")
        return [
            f"{_label(section, [*path, discriminator])}: unknown '{context['tag']}'{nearest(context['tag'], tags)}"
        ]
    allowed = item["msg"].replace("Input should be ", "must be ").replace("a valid ", "a ")
    allowed = {
        "float_type": "must be a number",
        "finite_number": "must be a finite number",
        "int_type": "must be a whole number",
        "string_type": "must be text in quotes",
        "bool_type": "must be true or false",
        "model_type": "must be a table",
        "model_attributes_type": "must be a table",
        "dict_type": "must be a table",
        "tuple_type": "must be a list",
    }.get(kind, allowed)
    return [f"{label}: given {_shown(item['input'])}, {allowed}{note}"]


def _resolve(
    loc: Sequence[int | str], model: type[BaseModel], unknown_key: bool
) -> tuple[list[int | str], list[type[BaseModel]], bool, str]:
    """Key path without pydantic's tags of unions, models of the table around it, if it is a table, description."""
    path: list[int | str] = []
    holders: list[type[BaseModel]] = [model]
    inside: list[type[BaseModel]] = [model]
    description = ""
    for index, part in enumerate(loc):
        owners = [candidate for candidate in inside if part in candidate.model_fields]
        last = index == len(loc) - 1
        if isinstance(part, int):
            path.append(part)
        elif owners:
            path.append(part)
            field = owners[0].model_fields[part]
            description = (field.description or "").rstrip(".")
            holders, inside = inside, models_in(field.annotation, field.metadata)
        elif tagged := [candidate for candidate in inside if _has_tag(candidate, part)]:
            inside = tagged
        elif last and unknown_key:
            path.append(part)
            holders, description = inside, ""
    return path, holders, bool(inside), description


def models_in(*annotations: Any) -> list[type[BaseModel]]:
    """Every model class mentioned in type annotations."""
    found: list[type[BaseModel]] = []
    for annotation in annotations:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            found.append(annotation)
        else:
            found.extend(models_in(*get_args(annotation)))
    return found


def _has_tag(model: type[BaseModel], tag: str) -> bool:
    """Whether a member of a union told apart by a literal field goes by ``tag``."""
    return any(tag in get_args(field.annotation) for field in model.model_fields.values())


def _label(section: str, path: Sequence[int | str]) -> str:
    """``[table.table] key[index]`` from a path of keys."""
    keys: list[str] = [section] if section else []
    for part in path:
        if isinstance(part, int):
            keys[-1] += f"[{part}]"
        else:
            keys.append(part)
    return f"[{'.'.join(keys[:-1])}] {keys[-1]}" if len(keys) > 1 else "".join(keys)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
