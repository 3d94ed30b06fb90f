"""Mutations of tables and of bytes."""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator, Mapping
from typing import Any

from fuzzing.texts import HOSTILE, TOKENS


def deep(levels: int) -> Any:
    """A list in a list in a list ..."""
    value: Any = 1.0
    for _ in range(levels):
        value = [value]
    return value


def leaf_paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all entries of nested tables and lists, tables and lists included."""
    if path:
        yield path
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from leaf_paths(inner, (*path, key))
    elif isinstance(value, list) and len(value) < 50:
        for index, inner in enumerate(value):
            yield from leaf_paths(inner, (*path, index))


def mutated_value(rng: random.Random, table: dict[str, Any]) -> dict[str, Any]:
    """A copy of ``table`` with one entry replaced, removed, renamed, doubled or scaled."""
    table = copy.deepcopy(table)
    paths = list(leaf_paths(table))
    if not paths:
        return table
    path = rng.choice(paths)
    holder: Any = table
    for key in path[:-1]:
        holder = holder[key]
    key, kind = path[-1], rng.random()
    if kind < 0.3 and isinstance(holder[key], str):
        holder[key] = rng.choice([each for each in HOSTILE if isinstance(each, str)])
    elif kind < 0.62:
        holder[key] = (
            copy.deepcopy(rng.choice(HOSTILE)) if rng.random() < 0.98 else deep(rng.choice((5, 400)))
        )
    elif kind < 0.75 and isinstance(holder.get(key) if isinstance(holder, dict) else None, int | float):
        holder[key] = holder[key] * rng.choice((-1, 0, 1e-12, 1e-4, 0.5, 3, 1e4, 1e12, 1e200))
    elif kind < 0.83:
        del holder[key]
    elif isinstance(holder, dict):
        name = rng.choice(
            (f"{key}x", str(key)[:-1], str(key).upper(), "", "日", "a.b", "__class__", "self", "\x7f")
        )
        if kind < 0.92:
            holder[name] = holder.pop(key)
        else:
            holder[name] = copy.deepcopy(holder[key])
    else:
        holder.insert(key, copy.deepcopy(holder[key]))
    return table


def mutated_text(rng: random.Random, text: bytes) -> bytes:
    """``text`` with bytes flipped, removed, doubled, swapped, inserted or cut off."""
    at = rng.randrange(len(text) + 1)
    end = min(len(text), at + int(rng.expovariate(1 / 20)) + 1)
    match rng.randrange(7):
        case 0:
            flipped = bytearray(text)
            for place in rng.sample(range(len(text)), min(len(text), rng.randint(1, 4))):
                flipped[place] ^= 1 << rng.randrange(8)
            return bytes(flipped)
        case 1:
            return text[:at] + text[end:]
        case 2:
            return text[:end] + text[at:]
        case 3:
            lines = text.splitlines(keepends=True)
            rng.shuffle(lines)
            return b"".join(lines)
        case 4:
            return text[:at] + rng.choice(TOKENS) + text[at:]
        case 5:
            return text[:at] + bytes(rng.randrange(256) for _ in range(rng.randint(1, 30))) + text[end:]
    return text[:at]
