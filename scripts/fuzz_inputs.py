"""Feed mutated inputs to everything that reads what users give, and count what comes of it.

    python scripts/fuzz_inputs.py --count 12000 --seed 1 --record benchmarks/results/fuzz_inputs.json

Each input is valid but for one to three mutations: of the text (bytes flipped, cut, doubled, swapped), of values (wrong
types, huge, negative, nan, unicode, deep nesting, very long), of keys, of ``--set`` options, and of the bits of
checkpoints. It must be accepted with its values unchanged, or refused with a :class:`UserError` of at least one line.
A third outcome is a defect: another exception, more than ``LIMIT`` seconds, a value that is not the given one, or a
checkpoint that reads as something else than was written. Nothing is simulated: cases are loaded, checked, translated to
a problem and written out again. Ends with status 1 if there was a defect.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import random
import resource
import signal
import tempfile
import tomllib
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import tomli_w

from pfemcut.case import check
from pfemcut.case.load import load_case, resolved_toml
from pfemcut.case.translate import problem_of
from pfemcut.inputs import UserError
from pfemcut.materials.load import load_material
from pfemcut.results.checkpoint import read_file, write_checkpoint
from pfemcut.results.published import load_published
from pfemcut.sweep.study_file import read_plan
from pfemcut.validation.prediction import load_measurements
from pfemcut.validation.provenance import provenance
from pfemcut.wear.load import wear_table

ROOT = Path(__file__).resolve().parent.parent
LIMIT = 5.0
"""Seconds of processor time that one input may take."""
MEMORY = 4 << 30
"""Bytes that the process may use."""

CASES = (
    *sorted(ROOT.glob("demos/*/case.toml")),
    *sorted(ROOT.glob("tests/verification/*/case.toml")),
    *sorted(ROOT.glob("tests/verification/self_contact/[np]*.toml")),
)
MATERIALS = tuple(sorted(ROOT.glob("pfemcut/materials/library/*.toml")))
WEAR = tuple(sorted(ROOT.glob("pfemcut/wear/library/*.toml")))
PUBLISHED = tuple(sorted(ROOT.glob("demos/*/published.toml")))
MEASURED = tuple(sorted(ROOT.glob("demos/*/measured.toml")))

SWEEP = """\
case = "CASE"
output = "out/study"
figures = ["cutting_force", "chip_thickness"]
[set]
cutting.travel = 0.8
[grid]
cutting.speed = [1000, 3330.0]
"contact.friction" = [0.0, 0.2]
[zip]
tool.rake = [0.0, 6.0]
tool.tip_radius = [0.02, 0.025]
[[variant]]
name = "soft"
workpiece.material = "voce_steel"
"""
FULL_CASE = """\
title = "everything"
[workpiece]
length = 2.0
height = 1.0
temperature = 300.0
material = { base = "aisi4340", taylor_quinney = 0.8, hardening = { m = 1.0 } }
[tool]
model = "deformable"
rake = -5.0
clearance = 7.0
tip_radius = 0.02
wear = { A = 1e-9, B = 2000.0, above = { temperature = 1100.0, A = 1e-8, B = 3000.0 } }
body = { material = "tungsten_carbide", width = 0.8, height = 0.9, supports = "top" }
[cutting]
speed = 2000.0
depth = 0.1
travel = 0.6
[contact]
friction = { law = "coulomb", coefficient = 0.3 }
conductance = { value = 1e5, reference_pressure = 500.0, exponent = 0.9 }
self = { enabled = true, thickness = 0.004, penalty = 1e6, friction = 0.1 }
[mesh]
tip_size = 0.005
coarsening = "stress"
[time]
step = 1e-7
largest_step = 4e-7
[solver]
tolerance = 1e-4
[output]
directory = "out"
"""

HOSTILE: tuple[Any, ...] = (
    *(0, 1, -1, 2, 10**6, 10**18, -(10**18), 10**400, 0.0, -0.0, 1e-300, 5e-324, 1e-30, 1e-9, 1e-3, 0.3, 7.5),
    *(-1.0, 1e3, 1e9, 1e30, 1e300, 1.8e308, -1e300, math.nan, math.inf, -math.inf, 89.999999, 0.49999999999),
    *(
        True,
        False,
        "",
        " ",
        "nan",
        "1.0",
        "aisi4340",
        "out",
        ".",
        "..",
        "/",
        "../../x",
        "/dev/null",
        "/dev/zero",
    ),
    *(
        "x" * 100_000,
        "a\x00b",
        "\u202e\u0000\ud7ff",
        "日本語",
        "🪓",
        "<script>alert(1)</script>",
        "a\nb",
        "%s{}",
    ),
    *("~", "C:\\x", "con.toml", "none.toml", "/proc/self/mem", "/proc/self/environ", "elastic", "coulomb"),
    *([], [[]], [1.0], [1, 2, 3], ["a"], [0.0, math.nan], [1.0] * 20_000, {}, {"a": 1}, {"law": "coulomb"}),
    *(
        {"base": "aisi4340"},
        {"base": 3},
        {"law": []},
        {"law": {}},
        {"time": [0.0, 1.0], "value": [0.0, 1e300]},
    ),
    *(
        {"temperature": [300.0, 1e9], "value": [1.0, 1e300]},
        {"temperature": [], "value": []},
        [{}],
        [{"name": "b"}],
    ),
)


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


TOKENS = (
    *(
        b"\x00",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"=",
        b"[",
        b"]]",
        b"[[",
        b"{",
        b"}",
        b'"',
        b"'''",
        b'"""',
        b"#",
        b"\r",
    ),
    *(
        b"nan",
        b"inf",
        b"-",
        b"e",
        b"9" * 5000,
        b"0x",
        b"1_",
        b"\\u0000",
        b"1979-05-27T07:32:00Z",
        b"[" * 3000,
    ),
    *(
        b"a." * 2000,
        b"{a=" * 500,
        b"true",
        b"\xf0\x9f\xaa\x93",
        b"\n[workpiece]\n",
        b"\n[[body]]\n",
        b"\n[a.b.c]\n",
    ),
)


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


def try_case(path: Path, overrides: tuple[str, ...] = ()) -> None:
    """Load, check, translate and write out a case."""
    case, material = load_case(path, overrides)
    resolved = resolved_toml(case, material)
    if not overrides:
        require_same_values(
            tomllib.loads(path.read_text("utf-8").removeprefix("\ufeff")), tomllib.loads(resolved)
        )
    check.figures(case, material, path.parent)
    check.warnings(case, material, path.parent)
    problem_of(case, material, path.parent)


def try_material(path: Path) -> None:
    """Load a material file."""
    load_material(str(path), path.parent)


def try_wear(path: Path) -> None:
    """Load a file of wear constants."""
    wear_table(str(path), path.parent)


@dataclass(frozen=True)
class Kind:
    """A kind of input: valid texts, and what reads them."""

    texts: tuple[str, ...]
    read: Callable[[Path], object]


def kinds() -> dict[str, Kind]:
    """All kinds of text files that users give."""

    def texts(paths: tuple[Path, ...]) -> tuple[str, ...]:
        return tuple(path.read_text("utf-8") for path in paths)

    sweep = SWEEP.replace("CASE", str(ROOT / "demos/aisi4340_demo/case.toml"))
    return {
        "case": Kind((*texts(CASES), FULL_CASE), try_case),
        "material": Kind(texts(MATERIALS), try_material),
        "wear": Kind(texts(WEAR), try_wear),
        "published": Kind(texts(PUBLISHED), load_published),
        "measured": Kind(texts(MEASURED), load_measurements),
        "sweep": Kind((sweep,), read_plan),
    }


SHARES = {
    "case": 12,
    "material": 3,
    "wear": 1,
    "published": 1,
    "measured": 1,
    "sweep": 2,
    "set": 2,
    "checkpoint": 3,
}
"""Of the inputs."""


@dataclass
class Fuzzer:
    """Makes inputs and judges what comes of them.

    Attributes
    ----------
    seed
        Number ``n`` of a seed gives the same input for ever.
    folder
        Where inputs are written.
    """

    seed: int
    folder: Path

    def __post_init__(self) -> None:
        self.kinds = kinds()
        generator = np.random.default_rng(self.seed)
        self.state = {
            "fields/a": generator.random((200, 3)),
            "fields/b": generator.random(20),
            "mesh/cells": generator.integers(0, 99, (100, 3)),
            "clock/time": np.asarray(1e-7),
        }
        write_checkpoint(self.folder / "whole.h5", self.state, FULL_CASE, 7)
        self.image = (self.folder / "whole.h5").read_bytes()

    def make(self, number: int) -> tuple[str, Callable[[], object]]:
        """Return the kind of input ``number`` and what reads it."""
        rng = random.Random(f"{self.seed} {number}")
        kind = rng.choices(list(SHARES), list(SHARES.values()))[0]
        if kind == "checkpoint":
            return kind, self._checkpoint(rng)
        if kind == "set":
            path = self.folder / "set.toml"
            path.write_text(FULL_CASE, "utf-8")
            override = _override(rng)
            return kind, lambda: try_case(path, (override,))
        known = self.kinds[kind]
        text, way = rng.choice(known.texts).encode(), "text"
        if rng.random() < 0.65:
            way, table = "value", tomllib.loads(text.decode())
            for _ in range(rng.choice((1, 1, 1, 2, 3))):
                table = mutated_value(rng, table)
            try:
                text = tomli_w.dumps(table).encode("utf-8", "surrogatepass")
            except (RecursionError, TypeError, ValueError):
                way = "text"
        if way == "text":
            for _ in range(rng.choice((1, 1, 1, 2, 3))):
                text = mutated_text(rng, text)
        path = self.folder / f"{kind}.toml"
        path.write_bytes(text)
        return f"{kind} {way}", lambda: known.read(path)

    def _checkpoint(self, rng: random.Random) -> Callable[[], object]:
        image = self.image
        for _ in range(rng.choice((1, 1, 1, 2, 8))):
            image = mutated_text(rng, image)
        path = self.folder / "checkpoint.h5"
        path.write_bytes(image)

        def read() -> None:
            found = read_file(path)
            same = (
                found.step == 7
                and found.resolved_case == FULL_CASE
                and found.state.keys() == self.state.keys()
            )
            if not same or any(found.state[name].tobytes() != a.tobytes() for name, a in self.state.items()):
                raise Changed("checkpoint: reads as something else")

        return read

    def outcome(self, number: int) -> tuple[str, str, str]:
        """Return the kind of input ``number``, the outcome (accepted, refused or a defect) and its details."""
        kind, read = self.make(number)
        try:
            with limited(LIMIT), warnings.catch_warnings():
                warnings.simplefilter("error")
                read()
        except UserError as error:
            lines = str(error).splitlines()
            if not lines or not all(line.strip() for line in lines) or max(map(len, lines)) > 2000:
                return kind, "defect: unclear message", str(error)[:300]
            return kind, "refused", str(error)
        except TooSlow:
            return kind, "defect: too slow", traceback.format_exc(limit=-6)
        except Changed as error:
            return kind, "defect: changed", str(error)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            return kind, f"defect: {type(error).__name__}", traceback.format_exc(limit=-6)
        return kind, "accepted", ""


def _override(rng: random.Random) -> str:
    keys = [".".join(map(str, path)) for path in leaf_paths(tomllib.loads(FULL_CASE))]
    key, value = rng.choice(keys), rng.choice(HOSTILE)
    text = {True: "true", False: "false"}.get(value) if isinstance(value, bool) else str(value)
    made = f"{key}={text}"
    if rng.random() < 0.4:
        made = mutated_text(rng, made.encode("utf-8", "replace")).decode("utf-8", "replace")
    return made


def fuzz(seed: int, numbers: range, tell: Callable[[str], object] = print) -> Counter[tuple[str, str]]:
    """Try the inputs ``numbers`` of a seed; count outcomes by kind, and tell of each defect."""
    counts: Counter[tuple[str, str]] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        fuzzer = Fuzzer(seed, Path(folder))
        for number in numbers:
            kind, outcome, details = fuzzer.outcome(number)
            counts[kind, outcome] += 1
            if outcome.startswith("defect"):
                tell(f"input {number} of seed {seed} ({kind}): {outcome}\n{details}")
    return counts


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=12_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--record", type=Path, help="JSON file for the counts")
    given = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    counts = fuzz(given.seed, range(given.first, given.first + given.count))
    table: dict[str, dict[str, int]] = {}
    for (kind, outcome), count in sorted(counts.items()):
        table.setdefault(kind, {})[outcome] = count
    totals = Counter[str]()
    for (_, outcome), count in counts.items():
        totals[outcome] += count
    print(json.dumps({"totals": totals, **table}, indent=2))
    if given.record:
        content: dict[str, Any] = {"inputs": given.count, "seed": given.seed, "limit_seconds": LIMIT}
        content["totals"] = dict(sorted(totals.items()))
        content |= {"by_kind": table, "provenance": provenance()}
        given.record.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", "utf-8")
    return int(any(outcome.startswith("defect") for outcome in totals))


if __name__ == "__main__":
    raise SystemExit(main())
