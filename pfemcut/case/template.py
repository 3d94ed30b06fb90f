"""A commented case file of an orthogonal cut, written from the schema: what a newcomer starts from."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from pfemcut.case.schema import Case, Cutting, Tool
from pfemcut.case.wording import allowed
from pfemcut.inputs import InputError, explained, models_in
from pfemcut.units import in_other

WIDTH = 110
HEAD = """\
# A case file of pfemcut, an orthogonal cut:
#     pfemcut check {name}      validates it and shows its main figures
#     pfemcut run {name}        cuts
# Plain numbers are in mm, tonne, s, K (so N, MPa, mJ) and degrees; text brings its unit: "200 m/min", "65 degC".
# Lines such as "#key = value" hold defaults; take away the # to change one.
"""


def case_template(name: str, material: str, rake: Any, tip_radius: Any, speed: Any, depth: Any) -> str:
    """The text of a case file with every key of the schema, its meaning, unit, range and default.

    Block, travel, mesh and step are made to suit the cut: their rules are those that ``pfemcut check`` warns by.

    Parameters
    ----------
    name
        Name of the file, for its first lines.
    material
        Name in the library, or path to a material file.
    rake, tip_radius, speed, depth
        Numbers in base units, or text with a unit; they are written as they are given.

    Raises
    ------
    InputError
        If the tool or the cut is none; one line a problem.
    """
    tool, cutting = _tool_and_cut(rake, tip_radius, speed, depth)
    values: dict[str, dict[str, Any]] = {
        "workpiece": {"material": material},
        "tool": {"rake": rake, "tip_radius": tip_radius},
        "cutting": {"speed": speed, "depth": depth},
    }
    for section, chosen in suited(tool, cutting).items():
        values[section] = {**values.get(section, {}), **chosen}
    lines = [HEAD.format(name=" ".join(name.split())).rstrip()]
    for key, field in Case.model_fields.items():
        if key == "title":
            lines += _key(key, field, _title(material, tool, cutting))
        elif not (tables := models_in(field.annotation, field.metadata)):
            lines += _key(key, field)
        else:
            lines += _section(key, tables[0], values.get(key, {}))
    return "\n".join(lines).rstrip() + "\n"


_DEMO_TIP, _DEMO_PENALTY = 0.005, 4e7  # mm, MPa/mm


def suited(tool: Tool, cutting: Cutting) -> Mapping[str, Mapping[str, float]]:
    """Values that suit a tool and a cut, by section and key.

    Half a millimetre of travel or ten depths gives steady means; the block is twenty depths larger than the travel,
    and high. Sizes go with the depth, at the tip with its radius, in the ratios of the demo of AISI 4340, as do the
    steps: the tool advances 0.07 of the size at the tip in the first ones, and 0.28 at most. Below that demo's size at
    the tip the penalty grows, so that particles sink in by the same part of it.
    """
    depth = cutting.depth
    travel = max(0.5, 10.0 * depth)
    tip_size = min(tool.tip_radius / 5.0, 0.1 * depth)
    chosen = {
        "workpiece": {"length": travel + 20.0 * depth, "height": 20.0 * depth},
        "cutting": {"travel": travel},
        "mesh": {
            "tip_size": tip_size,
            "shear_zone_size": 0.1 * depth,
            "chip_size": 0.15 * depth,
            "surface_size": 0.15 * depth,
            "far_size": 4.0 * depth,
        },
        "time": {
            "step": 0.07 * tip_size / cutting.speed,
            "largest_step": 0.28 * tip_size / cutting.speed,
        },
    }
    if tip_size < _DEMO_TIP:
        chosen["contact"] = {"penalty": _DEMO_PENALTY * _DEMO_TIP / tip_size}
    return {
        section: {key: float(f"{value:.3g}") for key, value in keys.items()}
        for section, keys in chosen.items()
    }


def _title(material: str, tool: Tool, cutting: Cutting) -> str:
    speed, unit = in_other(cutting.speed, "mm/s") or (cutting.speed, "mm/s")
    return f"{material}, rake {tool.rake:.4g} degrees, {speed:.4g} {unit}, {cutting.depth:.4g} mm deep"


def _tool_and_cut(rake: Any, tip_radius: Any, speed: Any, depth: Any) -> tuple[Tool, Cutting]:
    """The tool and the cut, in base units."""
    problems: list[str] = []
    made: list[BaseModel] = []
    tables: tuple[tuple[type[BaseModel], str, dict[str, Any]], ...] = (
        (Tool, "tool", {"rake": rake, "tip_radius": tip_radius}),
        (Cutting, "cutting", {"speed": speed, "depth": depth, "travel": 1.0}),
    )
    for model, section, table in tables:
        try:
            made.append(model.model_validate(table))
        except ValidationError as error:
            problems += explained(error, model, section)
    if problems:
        raise InputError(problems)
    tool, cutting = made
    assert isinstance(tool, Tool) and isinstance(cutting, Cutting)
    return tool, cutting


def _section(
    name: str, model: type[BaseModel], values: Mapping[str, Any], optional: bool = False
) -> list[str]:
    """A table: its keys, then its inner tables; those that may be left out as comments."""
    lines = ["", *_words(model.__doc__ or ""), f"{'#' if optional else ''}[{name}]"]
    inner: list[str] = []
    # What was chosen comes before what is left at its default.
    for key, field in sorted(model.model_fields.items(), key=lambda item: item[0] not in values):
        tables = [each for each in models_in(field.annotation) if "law" not in each.model_fields]
        # A table in the place of a number is described by its key.
        if tables and not allowed(field).startswith("number"):
            inner += _section(f"{name}.{key}", tables[0], {}, optional=True)
        else:
            lines += _key(key, field, values.get(key), optional)
    return [*lines, *inner]


def _key(key: str, field: FieldInfo, value: Any = None, optional: bool = False) -> list[str]:
    """A key with its meaning and range above it; as a comment if its default will do."""
    words = f"{field.description}; {allowed(field)}".replace("`", "")
    if value is not None:
        return ["", *_words(words), _written(key, value)]
    if field.is_required():
        return ["", *_words(f"{words}; required"), f"#{key} = "]
    given = field.get_default(call_default_factory=False)
    return ["", *_words(words), f"#{key} = " if given is None else f"#{_written(key, given)}"]


def _written(key: str, value: Any) -> str:
    if isinstance(value, (list, tuple)):
        # On one line, since the caller may make a comment of it.
        items = (_written("item", each).removeprefix("item = ") for each in value)
        return f"{key} = [{', '.join(items)}]"
    return tomli_w.dumps({key: value}).strip()


def _words(text: str) -> list[str]:
    unbroken = re.sub("([<>≤≥]) ", "\\1\N{NO-BREAK SPACE}", " ".join(text.split()))
    lines = textwrap.wrap(unbroken, WIDTH, initial_indent="# ", subsequent_indent="#   ")
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in lines]
