"""Damaged output folders, and the commands that read them."""

from __future__ import annotations

import contextlib
import io
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzzing.judgement import judged
from fuzzing.mutations import mutated_text
from pfemcut import load_case, run
from pfemcut.cli.main import status
from pfemcut.inputs import UserError
from pfemcut.watch.picture import FIELD_NAMES, FieldPictures
from pfemcut.watch.server import history_json, state_json
from pfemcut.watch.state import RunReader
from pfemcut.watch.terminal import line, view

LIMIT = 30.0
"""Seconds of processor time that one command may take."""
CASE = """\
[workpiece]
length = 0.6
height = 0.3
material = "aisi4340"
[tool]
tip_radius = 0.025
[cutting]
speed = 3330.0
depth = 0.1
travel = 0.0015
[mesh]
tip_size = 0.012
shear_zone_size = 0.04
chip_size = 0.04
surface_size = 0.04
growth = 0.3
[time]
step = 1.5e-7
[output]
every = 2
checkpoint_every = 2
figures = false
"""
LEVELS = 3
COMMANDS = {"report": 3, "compare": 4, "watch": 5, "resume": 3, "converge": 3}
"""Shares of the commands."""


class Refused(UserError):
    """A command that ended with status 2, or 1, and what it said."""


class Folders:
    """Damages the folder of a small cut and judges what the commands make of it.

    Parameters
    ----------
    seed
        Number ``n`` of a seed gives the same damage for ever.
    folder
        Where it works.
    """

    def __init__(self, seed: int, folder: Path) -> None:
        self._seed, self._folder = seed, folder
        self._case = folder / "case.toml"
        self._case.write_text(CASE, "utf-8")
        with contextlib.redirect_stdout(io.StringIO()):
            run(load_case(self._case), folder / "whole")
        self._study = folder / "study"
        # The levels of a study whose folders are what its runs would leave.
        self._levels = self._prepared_levels()

    def _prepared_levels(self) -> list[str]:
        from pfemcut.case.load import resolved_toml
        from pfemcut.converge.refinement import What
        from pfemcut.converge.study import planned
        from pfemcut.sweep.prepare import prepared

        study = planned(
            self._case, self._study, what=What.MESH, ratio=1.2, levels=LEVELS, finer=0, common={}, figures=()
        )
        names = []
        for each in prepared(study.plan):
            shutil.copytree(self._folder / "whole", each.directory)
            (each.directory / "inputs.resolved.toml").write_text(
                resolved_toml(each.case, each.material), "utf-8"
            )
            names.append(each.name)
        return names

    def outcome(self, number: int) -> tuple[str, str, str]:
        """Return the command that is given damage ``number``, the outcome and its details."""
        rng = random.Random(f"{self._seed} {number}")
        command = rng.choices(list(COMMANDS), list(COMMANDS.values()))[0]
        study = self._folder / "damaged_study"
        shutil.rmtree(study, ignore_errors=True)
        shutil.copytree(self._study, study)
        damaged = study / rng.choice(self._levels)
        if command != "converge":
            shutil.rmtree(damaged)
            shutil.copytree(self._folder / "whole", damaged)
        damage = [_damaged(rng, damaged) for _ in range(rng.choice((1, 1, 2, 3)))]
        outcome, details = judged(lambda: self._read(command, damaged), LIMIT)
        return command, outcome, f"{', '.join(damage)}\n{details}"

    def _read(self, command: str, damaged: Path) -> None:
        case, whole, study = self._case, self._folder / "whole", damaged.parent
        commands: dict[str, Callable[[], None]] = {
            "report": lambda: _command("report", damaged, "--no-animation"),
            "compare": lambda: _command("compare", damaged, whole, "-o", study / "compare"),
            "watch": lambda: _watched(damaged),
            "resume": lambda: _command("run", case, "-o", damaged, "--resume"),
            "converge": lambda: _command(
                "converge", case, "--ratio", "1.2", "--collect", "-o", study, "--levels", str(LEVELS)
            ),
        }
        commands[command]()


def _command(*arguments: object) -> None:
    """Call a command of ``pfemcut``; raises :class:`Refused` with its words."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        code = status([str(each) for each in arguments])
    if code:
        raise Refused(said.getvalue().strip())


def _watched(directory: Path) -> None:
    """What the page and the terminal ask for."""
    reader = RunReader(directory)
    state, history = reader.state(), reader.history()
    state_json(state)
    history_json(history, -1.0)
    line(state)
    view(state, history)
    FieldPictures(directory).png(FIELD_NAMES[0][0])


def _damaged(rng: random.Random, directory: Path) -> str:
    """Damage one of the files of a run; in words."""
    files = sorted(path for path in directory.rglob("*") if path.is_file())
    if not files:
        return "nothing left"
    # Tables and summaries as often as the many frames.
    folders = sorted({path.parent for path in files})
    path = rng.choice([each for each in files if each.parent == rng.choice(folders)] or files)
    content = path.read_bytes()
    match rng.randrange(7):
        case 0:
            path.unlink()
            return f"{path.name} gone"
        case 1:
            path.write_bytes(b"")
            return f"{path.name} empty"
        case 2:
            path.write_bytes(content[: rng.randrange(len(content) + 1)])
            return f"{path.name} cut short"
        case 3:
            path.write_bytes(rng.choice(files).read_bytes())
            return f"{path.name} another file"
        case 4 if path.suffix in (".json", ".csv", ".toml"):
            path.write_bytes(_numbers_changed(rng, content))
            return f"{path.name} with other numbers"
        case 5:
            path.unlink()
            path.mkdir()
            return f"{path.name} a folder"
    for _ in range(rng.choice((1, 2, 5))):
        content = mutated_text(rng, content)
    path.write_bytes(content)
    return f"{path.name} changed"


def _numbers_changed(rng: random.Random, content: bytes) -> bytes:
    """A table or a JSON file with a value replaced."""
    pieces = content.replace(b",", b" , ").replace(b"\n", b" \n ").split(b" ")
    at = [
        index
        for index, piece in enumerate(pieces)
        if piece[:1].isdigit() or piece[:1] in (b"-", b"{", b"[", b'"')
    ]
    if at:
        pieces[rng.choice(at)] = rng.choice(WRONG)
    return b" ".join(pieces).replace(b" , ", b",").replace(b" \n ", b"\n")


WRONG = (*(b'nan inf -inf -1 0 1e400 1e300 null true [] {} "x" x'.split()), b"", str(np.pi).encode())
"""Values in the place of a number."""
