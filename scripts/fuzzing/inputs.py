"""Mutated case files, material files and all else that users write, options and checkpoints."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tomli_w

from fuzzing.judgement import Changed, judged, require_same_values
from fuzzing.mutations import leaf_paths, mutated_text, mutated_value
from fuzzing.texts import CASES, FULL_CASE, HOSTILE, MATERIALS, MEASURED, MESH, PUBLISHED, ROOT, SWEEP, WEAR
from pfemcut.case import check
from pfemcut.case.load import load_case, resolved_toml
from pfemcut.case.translate import problem_of
from pfemcut.materials.load import load_material
from pfemcut.results.checkpoint import read_file, write_checkpoint
from pfemcut.results.published import load_published
from pfemcut.sweep.study_file import read_plan
from pfemcut.validation.prediction import load_measurements
from pfemcut.wear.load import wear_table

LIMIT = 5.0
"""Seconds of processor time that one input may take."""
MESHED_CASE = """\
problem = "general"
[[body]]
mesh = "MESH"
material = "aisi4340"
[[boundary]]
part = "bottom"
displacement = { x = 0.0, y = 0.0 }
[mesh]
size = 0.3
[time]
step = 1e-7
end = 1e-6
"""


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


def try_mesh(path: Path) -> None:
    """Check and translate a case whose body is a mesh file."""
    case = path.with_name("meshed.toml")
    case.write_text(MESHED_CASE.replace("MESH", path.name), "utf-8")
    found, material = load_case(case)
    check.warnings(found, material, path.parent)
    problem_of(found, material, path.parent)


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


NUMBERS = tuple(b"0 1 2 3 4 5 6 7 9 -1 nan inf 1e300 -0.5 1e-300 99999999999 2147483648 x 0.5 15 3.5".split())
"""That stand in a mesh file where others stood."""
SHARES = {
    "case": 12,
    "material": 3,
    "wear": 1,
    "published": 1,
    "measured": 1,
    "sweep": 2,
    "set": 2,
    "checkpoint": 3,
    "mesh": 2,
}
"""Of the inputs."""


@dataclass
class Inputs:
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
        if kind == "mesh":
            path = self.folder / "mesh.msh"
            path.write_bytes(_mutated_mesh(rng))
            return kind, lambda: try_mesh(path)
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
        return kind, *judged(read, LIMIT)


def _override(rng: random.Random) -> str:
    keys = [".".join(map(str, path)) for path in leaf_paths(tomllib.loads(FULL_CASE))]
    key, value = rng.choice(keys), rng.choice(HOSTILE)
    text = {True: "true", False: "false"}.get(value) if isinstance(value, bool) else str(value)
    made = f"{key}={text}"
    if rng.random() < 0.4:
        made = mutated_text(rng, made.encode("utf-8", "replace")).decode("utf-8", "replace")
    return made


def _mutated_mesh(rng: random.Random) -> bytes:
    """A mesh file with bytes changed, or with numbers in it replaced."""
    text = MESH.encode()
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        if rng.random() < 0.5:
            text = mutated_text(rng, text)
            continue
        lines = text.split(b"\n")
        at = rng.randrange(len(lines))
        words = lines[at].split()
        if words:
            words[rng.randrange(len(words))] = rng.choice(NUMBERS)
            lines[at] = b" ".join(words)
        text = b"\n".join(lines)
    return text
