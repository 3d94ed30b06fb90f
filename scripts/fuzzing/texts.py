"""Valid texts that mutations start from, and values and pieces of text that mean harm."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]

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

MESH = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "bottom"
1 2 "top"
$EndPhysicalNames
$Nodes
6
1 0.0 0.0 0.0
2 1.0 0.0 0.0
3 1.0 1.0 0.0
4 0.0 1.0 0.0
5 0.5 0.5 0.0
6 2.0 2.0 0.0
$EndNodes
$Elements
6
1 1 2 1 1 1 2
2 1 2 2 2 3 4
3 2 2 3 3 1 2 5
4 2 2 3 3 2 3 5
5 2 2 3 3 3 4 5
6 2 2 3 3 4 1 5
$EndElements
"""
"""A square of four triangles with two named sides, as gmsh writes it."""
