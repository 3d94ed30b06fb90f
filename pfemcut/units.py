"""Units of inputs and outputs: text such as ``"200 m/min"`` to a number in base units, and numbers shown in both.

Base units are mm, tonne, s, K (so N, MPa, mJ), and degrees for angles. A key of the schema declares its unit once, in
brackets in its description.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pint import UnitRegistry


@dataclass(frozen=True)
class Kind:
    """A kind of quantity that keys of the schema may have.

    Attributes
    ----------
    unit
        Its base unit, as descriptions have it.
    name
        What messages call it, with its article.
    example
        A value with a unit that users may prefer.
    other
        Unit that engineers use, in ASCII letters so that it can be typed; empty if it is the base unit.
    factor, offset
        value in ``other`` = factor * value + offset.
    """

    unit: str
    name: str
    example: str
    other: str = ""
    factor: float = 1.0
    offset: float = 0.0


KINDS = (
    Kind("mm", "a length", "0.1 mm"),
    Kind("mm/s", "a speed", "200 m/min", "m/min", 0.06),
    Kind("s", "a time", "0.1 us"),
    Kind("K", "a temperature", "65 degC", "degC", 1.0, -273.15),
    Kind("degrees", "an angle", "15 deg"),
    Kind("MPa", "a stress", "210 GPa"),
    Kind("N/mm", "a force per width", "200 N/mm"),
    Kind("tonne/mm³", "a density", "7830 kg/m^3", "kg/m^3", 1e12),
    Kind("mm²/(s² K)", "a specific heat", "477 J/(kg K)", "J/(kg K)", 1e-6),
    Kind("N/(s K)", "a thermal conductivity", "44 W/(m K)", "W/(m K)"),
    Kind("N/(mm s K)", "a heat transfer coefficient", "1e8 W/(m^2 K)", "W/(m^2 K)", 1e3),
    Kind("N/(mm s)", "a heat flux", "50 W/mm^2", "W/mm^2", 1e-3),
    Kind("MPa/mm", "a pressure per length", "4e7 MPa/mm"),
    Kind("1/K", "a value per temperature", "12e-6 1/K"),
    Kind("1/s", "a rate", "1e3 1/s"),
)
"""All kinds of quantities in the schema."""

PURE = "dimensionless"
"""What descriptions call a pure number."""

_OTHER_NAMES = (
    ("kg", "a mass"),
    ("N", "a force"),
    ("mm^2", "an area"),
    ("mm^3", "a volume"),
    ("J", "an energy"),
    ("W", "a power"),
    ("rpm", "a speed of rotation"),
    ("C", "an electric charge (degC is a temperature)"),
    ("K/s", "a rate of temperature"),
)
_SYNONYMS = {"degree": "degrees"}

_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)")
_SIGNS = str.maketrans({"·": "*", "⋅": "*", "−": "-", "μ": "µ"})
_RAISED = re.compile("⁻?[¹²³⁴⁵⁶⁷⁸⁹]")
_DIGITS_OF_RAISED = str.maketrans("⁻¹²³⁴⁵⁶⁷⁸⁹", "-123456789")
# Nothing more is handed to pint: it would also take arithmetic, with powers that fill the memory.
_TERM = r"[A-Za-zµ_]+(?:\s*\^\s*-?\s*[1-9])?"
_FACTOR = rf"(?:{_TERM}|\(\s*{_TERM}(?:(?:\s*\*\s*|\s+){_TERM})*\s*\))"
_UNIT = re.compile(rf"(?:{_FACTOR}|1\s*/\s*{_FACTOR})(?:(?:\s*[*/]\s*|\s+){_FACTOR})*")
_LONGEST = 80
_DIGITS = 15
_BRACKETS = re.compile(r"\(((?:[^()]|\([^()]*\))*)\)")


class UnitError(ValueError):
    """A text that is no quantity of the kind that is expected; the message says what is."""


@cache
def declared(description: str) -> Kind | None:
    """The kind of a key by the unit that its description names; None without one."""
    unit, _ = unit_and_words(description)
    return next((kind for kind in KINDS if kind.unit == unit), None)


def unit_and_words(description: str) -> tuple[str, str]:
    """Split a description of the schema: the first unit in brackets, up to a semicolon, and the rest without it."""
    known = {PURE, *(kind.unit for kind in KINDS)}
    for brackets in _BRACKETS.finditer(description):
        unit, _, more = (part.strip() for part in brackets[1].partition(";"))
        if unit in known:
            more = f" ({more})" if more else ""
            return unit, f"{description[: brackets.start()].rstrip()}{more}{description[brackets.end() :]}"
    return "", description


def both(value: float, unit: str, digits: int = 4) -> str:
    """A value in its base unit, and in the unit that engineers use if that is another one.

    Parameters
    ----------
    value
        The value.
    unit
        Its unit, as in the schema and in ``summary.json``; ``-`` for a pure number.
    digits
        Significant digits.

    Examples
    --------
    >>> both(3330.0, "mm/s")
    '3330 mm/s = 199.8 m/min'
    >>> both(0.1, "mm")
    '0.1 mm'
    """
    base = f"{value:.{digits}g}" + ("" if unit in ("-", "1", "") else f" {unit}")
    other = in_other(value, unit)
    return f"{base} = {other[0]:.{digits}g} {other[1]}" if other else base


def in_other(value: float, unit: str) -> tuple[float, str] | None:
    """The value in the unit that engineers use, and that unit; None if they use the base unit."""
    wanted = _SYNONYMS.get(unit, unit)
    kind = next((kind for kind in KINDS if kind.unit == wanted and kind.other), None)
    return (kind.factor * value + kind.offset, kind.other) if kind else None


def in_base_unit(text: str, kind: Kind) -> float:
    """The value of a text such as ``"200 m/min"`` in the base unit of ``kind``.

    A temperature on a scale with an offset (degC, degF) is absolute; in a compound unit such as ``J/(kg degC)`` it is
    a difference. Other units than the base unit are rounded to 15 digits, so that the value is that of the plain
    number, bit for bit.

    Raises
    ------
    UnitError
        If the text is no number with a unit, or one of another kind.
    """
    expected = f"must be {kind.name} such as '{kind.example}', or a number ({kind.unit})"
    shown = repr(text) if len(text) <= _LONGEST else repr(text[:_LONGEST] + "...")
    match = _NUMBER.match(text)
    if match is None or len(text) > _LONGEST:
        raise UnitError(f"given {shown}, {expected}")
    number = float(match[1])
    unit = _plainly_written(text[match.end() :])
    if not unit:
        raise UnitError(f"given {shown}, which has no unit: {expected}")
    if _UNIT.fullmatch(unit) is None:
        raise UnitError(f"given {shown}, {expected}")
    return _converted(number, unit, kind, shown, expected)


def _plainly_written(unit: str) -> str:
    """The unit with powers as ``^``, without signs outside ASCII but the micro sign."""
    unit = unit.replace("°C", "degC").replace("°F", "degF").replace("°", "deg")
    unit = _RAISED.sub(lambda power: "^" + power[0].translate(_DIGITS_OF_RAISED), unit)
    unit = unit.translate(_SIGNS).replace("**", "^").strip()
    return f"1{unit}" if unit.startswith("/") else unit


def _converted(number: float, unit: str, kind: Kind, shown: str, expected: str) -> float:
    import pint

    registry = _registry()
    base = _plainly_written(kind.unit)
    try:
        given, wanted = registry.parse_units(unit), registry.parse_units(base)
        roots = registry.get_root_units(given)[1]
    except pint.UndefinedUnitError as error:
        names = [error.unit_names] if isinstance(error.unit_names, str) else list(error.unit_names)
        raise UnitError(f"given {shown}, unknown unit '{names[0]}': {expected}") from None
    except (pint.PintError, ValueError, TypeError, ArithmeticError, AttributeError):
        raise UnitError(f"given {shown}, {expected}") from None
    # Roots instead of dimensions, for which an angle is a pure number and a rotation a rate.
    if roots != registry.get_root_units(wanted)[1]:
        name = _name_of(unit)
        raise UnitError(
            f"given {shown}, which is {name}: {expected}" if name else f"given {shown}, {expected}"
        )
    if kind.unit == "K" and "delta_" in str(given):
        raise UnitError(f"given {shown}, which is a temperature difference: {expected}")
    if given == wanted:
        return number
    value = float(registry.Quantity(number, given).to(wanted).magnitude)
    return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else value


@cache
def _name_of(unit: str) -> str:
    """What a quantity in ``unit`` is, in words; empty if it has no name."""
    registry = _registry()
    roots = registry.get_root_units(registry.parse_units(unit))[1]
    known = [(kind.unit, kind.name) for kind in KINDS]
    for each, name in (*known, *_OTHER_NAMES):
        if registry.get_root_units(registry.parse_units(_plainly_written(each)))[1] == roots:
            return name
    return ""


@cache
def _registry() -> UnitRegistry:
    # Here, as a case of plain numbers needs none: it takes a quarter of a second.
    from pint import UnitRegistry

    return UnitRegistry()
