"""Numbers and units as a reader wants them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pfemcut.units import in_other

MICROMETRES_BELOW = 0.1
"""Lengths below this (mm) are shown in micrometres too."""

_TIMES = {
    # unit: (factor, unit, smallest magnitude that is worth converting), beside those of pfemcut.units
    "MPa": (1e-3, "GPa", 1e4),
    "N/mm²": (1e-3, "J/mm³", 0.0),
    "s": (1e6, "µs", 0.0),
}
_PRINTED = str.maketrans({"2": "²", "3": "³", "^": None})


def significant(value: float, digits: int = 4) -> str:
    """Return ``value`` with so many significant digits, without an exponent where a reader needs none."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{digits - 1}e}" if places > 7 or places < -4 else f"{value:.{max(places, 0)}f}"


def with_scatter(mean: float, std: float) -> tuple[str, str]:
    """Return mean and standard deviation as text, the mean to the second digit of its scatter.

    Never to more than five digits, and without scatter to four.
    """
    if not (math.isfinite(mean) and math.isfinite(std)) or std <= 0.0:
        return significant(mean), significant(std, 2)
    # Of the rounded one: 0.9999 is 1.0, not 1.00.
    places = 1 - math.floor(math.log10(float(f"{std:.1e}")))
    most = 4 - math.floor(math.log10(abs(mean))) if mean != 0.0 else places
    if min(places, most) > 7:
        return significant(mean), significant(std, 2)
    if places > most:
        return f"{round(mean, most):.{max(most, 0)}f}", significant(std, 2)
    return f"{round(mean, places):.{max(places, 0)}f}", f"{round(std, places):.{max(places, 0)}f}"


def figure_text(figure: Mapping[str, Any]) -> str:
    """Return a figure of the summary as text: mean ± standard deviation, or the value."""
    if "mean" not in figure:
        return significant(figure["value"])
    return " ± ".join(with_scatter(figure["mean"], figure["std"]))


def number(value: float, digits: int) -> str:
    """Return ``value`` with at most so many significant digits; 2e8 rather than 200000000 or 2e+08."""
    if not math.isfinite(value):
        return f"{value:g}"
    rounded = float(f"{value:.{digits - 1}e}")
    text = f"{rounded:.10g}" if abs(rounded) < 1e6 else f"{rounded:.9e}"
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return text
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{mantissa}e{int(exponent)}"


def shown(value: object) -> str:
    """Return an input value as text: numbers as they were given, lists with commas, yes or no."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value, 10)
    if isinstance(value, list | tuple):
        return ", ".join(shown(each) for each in value)
    if isinstance(value, dict):
        return "; ".join(f"{key} {shown(each)}" for key, each in value.items())
    return str(value)


def converted(value: object, unit: str, digits: int = 6) -> str:
    """Return a value in the unit that workshops and data sheets use, with that unit; empty if it is the same one.

    Parameters
    ----------
    value
        A number, or a list of numbers, in ``unit``; anything else has no other unit.
    unit
        One of mm-tonne-s-K.
    digits
        Significant digits.
    """
    if isinstance(value, list | tuple):
        parts = [converted(each, unit, digits) for each in value]
        if not parts or not all(parts):
            return ""
        other = parts[0].partition(" ")[2]
        return f"{', '.join(part.partition(' ')[0] for part in parts)} {other}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if unit == "mm":
        return f"{number(1e3 * value, digits)} µm" if 0.0 < abs(value) < MICROMETRES_BELOW else ""
    engineers = in_other(float(value), unit)
    if engineers:
        found, name = engineers
        if name == "degC":
            return f"{found:.{min(digits, 4)}g} °C"
        return f"{number(found, digits)} {name.translate(_PRINTED)}"
    factor, name, smallest = _TIMES.get(unit, (1.0, "", math.inf))
    return f"{number(factor * value, digits)} {name}" if abs(value) >= smallest and name else ""


def spoken(unit: str) -> str:
    """Return a unit as it stands behind a number: nothing for pure numbers, s⁻¹ for 1/s."""
    if unit.startswith("1/") and unit[2:].isalpha():
        return f"{unit[2:]}⁻¹"
    return {"-": "", "dimensionless": "", "degrees": "°", "degree": "°"}.get(unit, unit)
