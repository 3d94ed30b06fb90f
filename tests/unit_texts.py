"""Texts that look like quantities with units, right and wrong."""

from __future__ import annotations

import string

from hypothesis import strategies as st

finite = st.floats(allow_nan=False, allow_infinity=False)
ordinary = st.floats(min_value=1e-9, max_value=1e9)

PIECES = st.sampled_from(
    [
        "mm",
        "m",
        "s",
        "min",
        "degC",
        "K",
        "W",
        "kg",
        "delta_degC",
        "deg",
        "°",
        "²",
        "⁻¹",
        "µ",
        "^",
        "**",
        "*",
        "/",
    ]
    + [
        "(",
        ")",
        " ",
        "1",
        "-2",
        "e9",
        ".",
        "inf",
        "nan",
        "%",
        "_",
        "rad",
        "kilo",
        "N",
        "Pa",
        "\n",
        "\x00",
        "None",
    ]
    + ["[length]", "@", "="]
)
TEXTS = st.one_of(
    st.text(max_size=40),
    st.text(alphabet=string.printable, max_size=40),
    st.builds(lambda number, pieces: f"{number}{''.join(pieces)}", finite, st.lists(PIECES, max_size=12)),
)
