"""Case files: what is accepted, what a mistake says, and the problem that a cutting case becomes."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pfemcut.case.check import warnings
from pfemcut.case.cutting import cutting_problem, size_field, starting_tool
from pfemcut.case.load import CaseError, load_case, overridden, resolved_toml
from pfemcut.case.schema import Case, Mesh, Section
from pfemcut.materials.hardening.voce import Voce
from pfemcut.problem import HeatSource, Integrator

CASE = """\
title = "small cut"
[workpiece]
length = 2.0
height = 1.0
material = "aisi4340"
[tool]
rake = 6.0
tip_radius = 0.025
[cutting]
speed = 3330.0
depth = 0.1
travel = 0.5
[time]
step = 1e-7
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def problems(path: Path, *overrides: str) -> tuple[str, ...]:
    with pytest.raises(CaseError) as caught:
        load_case(path, overrides)
    assert "\n".join(caught.value.problems) == str(caught.value)
    assert all(line and "\n" not in line for line in caught.value.problems)
    return caught.value.problems


def cut(rake: float = 0.0, depth: float = 0.1, tip_radius: float = 0.025) -> Case:
    return Case.model_validate(
        {
            "workpiece": {"length": 2.0, "height": 1.0, "material": "aisi4340"},
            "tool": {"rake": rake, "tip_radius": tip_radius},
            "cutting": {"speed": 1000.0, "depth": depth, "travel": 0.5},
            "time": {"step": 1e-7},
        }
    )


def test_a_short_case_is_filled_with_defaults(case_file: Path) -> None:
    case, material = load_case(case_file)
    assert case.tool.clearance == 5.0
    assert case.mesh.tip_size == 0.005
    assert case.time.integrator == "implicit"
    assert material.name == "AISI 4340"


def test_whole_numbers_are_lengths_too(case_file: Path) -> None:
    assert load_case(case_file, ["workpiece.length=3"])[0].workpiece.length == 3.0


def test_overrides_are_toml_values_or_text(case_file: Path) -> None:
    case, _ = load_case(
        case_file,
        [
            "mesh.remesh=false",
            "output.every=7",
            "time.integrator=implicit",
            'title="a = b"',
            "contact.friction=0.2",
        ],
    )
    assert case.mesh.remesh is False
    assert case.output.every == 7
    assert case.time.integrator == "implicit"
    assert case.title == "a = b"
    assert case.contact.friction == 0.2


def test_an_override_reaches_into_a_library_material(case_file: Path) -> None:
    _, material = load_case(
        case_file, ["workpiece.material=voce_steel", "workpiece.material.hardening.flow_stress_softening=0.0"]
    )
    assert isinstance(material.hardening, Voce)
    assert material.hardening.flow_stress_softening == 0.0
    assert material.hardening.yield_stress == 450.0


def test_an_override_counts_tables_that_come_in_numbers() -> None:
    table = {"body": [{"name": "block", "material": "voce_steel"}], "boundary": [{"part": "left"}]}
    changed = overridden(table, "body.0.material.taylor_quinney=0.0")
    assert changed["body"] == [
        {"name": "block", "material": {"base": "voce_steel", "taylor_quinney": 0.0}},
    ]
    assert table["body"][0]["material"] == "voce_steel"
    with pytest.raises(CaseError, match="must have a number below 1 after 'boundary'"):
        overridden(table, "boundary.1.part=right")


def test_a_material_file_is_sought_beside_the_case(tmp_path: Path, case_file: Path) -> None:
    library = Path(__file__).parents[1] / "pfemcut" / "materials" / "library" / "voce_steel.toml"
    (tmp_path / "mine.toml").write_text(library.read_text(encoding="utf-8"), encoding="utf-8")
    assert load_case(case_file, ["workpiece.material=mine.toml"])[1].name == "Voce steel"


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("tool.rak=1.0", "[tool] rak: unknown key; did you mean 'rake'?"),
        ("worpiece.length=1.0", "worpiece: unknown key; did you mean 'workpiece'?"),
        ("cutting.depth=-0.1", "[cutting] depth: given -0.1, must be greater than 0: Uncut chip thickness"),
        ("cutting.depth=1.5", "[cutting] depth: given 1.5, must be less than [workpiece] height = 1"),
        ("cutting.travel=2.0", "[cutting] travel: given 2.0, must be less than [workpiece] length = 2"),
        ("cutting.speed=fast", "[cutting] speed: given 'fast', must be a speed such as"),
        ("cutting.speed=true", "[cutting] speed: given True, must be a number"),
        ("cutting.speed=nan", "[cutting] speed: given nan, must be"),
        ("time.step=inf", "[time] step: given inf, must be a finite number"),
        ("tool.tip_radius=0.0", "[tool] tip_radius: given 0.0, must be greater than 0"),
        ("tool.rake=45.0", "[tool] rake: given 45.0, must be less than 45"),
        ("tool.clearance=0.0", "[tool] clearance: given 0.0, must be greater than 0"),
        ("tool.model=deformable", "[tool] model: 'deformable' needs a table [tool.body]"),
        ('tool.body={ material = "aisi4340" }', "[tool] body: only of a deformable tool"),
        ("tool.model=soft", "[tool] model: given 'soft', must be 'rigid'"),
        ("method=sph", "method: 'sph' is not available yet"),
        ("problem=turning", "problem: given 'turning', must be 'cutting'"),
        ("time.integrator=explicit", "[time] integrator: given 'explicit', must be 'impl-ex' or 'implicit'"),
        (
            "contact.heat_partition=1.2",
            "[contact] heat_partition: given 1.2, must be less than or equal to 1",
        ),
        (
            'contact.friction={law="coulom", coefficient=0.2}',
            "[contact.friction] law: unknown 'coulom'; did you mean 'coulomb'?",
        ),
        (
            'contact.friction={law="coulomb", coefficient=0.2, exponnt=1.0}',
            "[contact.friction] exponnt: unknown key; allowed: 'law', 'coefficient'",
        ),
        ("contact.friction={coefficient=0.2}", "[contact.friction] law: missing"),
        ("contact.friction=3.0", "[contact] friction: given 3.0, must be less than or equal to 2"),
        (
            'contact.friction={law="sticking-sliding", coefficient=0.2}',
            "[contact.friction] needs shear_factor, shear_limit or both",
        ),
        ("contact.conductance={value=1.0}", "[contact.conductance] reference_pressure: missing"),
        ("tool.conduction={conductivity=1.0, capacity=1e9}", "[tool.conduction] density: missing"),
        ("output.every=0", "[output] every: given 0, must be greater than or equal to 1"),
        ("output.every=2.5", "[output] every: given 2.5, must be a whole number"),
        ("mesh.remesh=1", "[mesh] remesh: given 1, must be true or false"),
        ("mesh.boundary_removal=0.8", "[mesh] boundary_removal: given 0.8, must be less than half of"),
        (
            "mesh.interior_removal=0.6",
            "[mesh] interior_removal: given 0.6, must be less than interior_spacing",
        ),
        ("tool=3", "tool: given 3, must be a table"),
        (
            "workpiece.material=aisi434",
            "[workpiece] material: unknown material 'aisi434'; did you mean 'aisi4340'?",
        ),
        (
            "workpiece.material.hardening.a=1.0",
            "[workpiece.material.hardening] a: unknown key; did you mean 'A'?",
        ),
        ("workpiece.material=3", "[workpiece] material: given 3, must be"),
        ("cutting.depth", "--set: given 'cutting.depth', must be section.key=value"),
        ("=3", "--set: given '=3', must be section.key=value"),
        ("title.key=3", "--set: given 'title.key=3', but 'title' is not a table"),
    ],
)
def test_a_mistake_is_one_line_naming_key_value_and_remedy(
    case_file: Path, override: str, words: str
) -> None:
    (line,) = problems(case_file, override)
    assert words in line


def test_all_mistakes_are_reported_at_once(case_file: Path) -> None:
    lines = problems(case_file, "tool.rak=1.0", "cutting.depth=-1", "workpiece.material=granite")
    assert len(lines) == 3


def test_a_missing_key_is_named(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("speed = 3330.0\n", ""), encoding="utf-8")
    (line,) = problems(path)
    assert line.startswith("[cutting] speed: missing")


def test_a_file_that_can_not_be_read_says_why(tmp_path: Path, case_file: Path) -> None:
    assert "no such file" in problems(tmp_path / "nowhere.toml")[0]
    assert "is a directory" in problems(tmp_path)[0]
    case_file.write_bytes(b'title = "\xff\xfe"\n')
    assert "not UTF-8" in problems(case_file)[0]
    case_file.write_text("[tool]\nrake = = 3\n", encoding="utf-8")
    (line,) = problems(case_file)
    assert "syntax error" in line
    assert "line 2" in line


def test_an_editor_s_byte_order_mark_does_no_harm(case_file: Path) -> None:
    case_file.write_text(CASE, encoding="utf-8-sig")
    assert load_case(case_file)[0].title == "small cut"


def test_a_cut_too_short_to_heat_its_tool_is_warned_of(case_file: Path) -> None:
    body = 'tool.body={ material = "aisi4340", tip_size = 0.02 }'
    case, material = load_case(case_file, ["tool.model=deformable", body, "contact.conductance=1e5"])
    found = "\n".join(warnings(case, material))
    assert "its temperatures are those of a beginning cut" in found
    assert "[tool.body] tip_size = 0.02 mm resolves the tip radius" in found


@pytest.mark.parametrize("name", ["aisi4340", "42cd4", "voce_steel"])
def test_resolved_inputs_alone_give_the_same_case_again(tmp_path: Path, case_file: Path, name: str) -> None:
    case, material = load_case(case_file, [f"workpiece.material={name}", "contact.friction=0.3"])
    elsewhere = tmp_path / "elsewhere" / "inputs.resolved.toml"
    elsewhere.parent.mkdir()
    text = resolved_toml(case, material)
    elsewhere.write_text(text, encoding="utf-8")
    again, same_material = load_case(elsewhere)
    assert same_material == material
    assert cutting_problem(again, same_material) == cutting_problem(case, material)
    assert resolved_toml(again, same_material) == text


@pytest.mark.parametrize(
    "friction",
    [
        '{law="sticking-sliding", coefficient=0.4, shear_limit=576.0}',
        '{law="table", coefficient={at=[300.0, 900.0], value=[0.4, 0.2]}}',
        '{law="usui", coefficient=0.4}',
    ],
)
def test_resolved_inputs_keep_friction_and_heat(tmp_path: Path, case_file: Path, friction: str) -> None:
    overrides = [f"contact.friction={friction}", "contact.conductance={value=1.0, reference_pressure=100.0}"]
    overrides.append("tool.conduction={conductivity=100.0, capacity=0.2e9, density=14.85e-9}")
    case, material = load_case(case_file, overrides)
    path = tmp_path / "inputs.resolved.toml"
    path.write_text(resolved_toml(case, material), encoding="utf-8")
    assert cutting_problem(*load_case(path)) == cutting_problem(case, material)


def test_the_problem_has_the_case_s_geometry_and_controls(case_file: Path) -> None:
    case, material = load_case(case_file, ["time.integrator=implicit", "time.heat_source=extrapolated"])
    problem = cutting_problem(case, material)
    assert problem.body.outline == ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0))
    assert problem.body.parts == ("bottom", "side", "top", "fixed")
    assert problem.body.temperature == 293.15
    assert {(m.part, m.axis.name, m.displacement(1.0)) for m in problem.motions} == {
        ("bottom", "X", 0.0),
        ("bottom", "Y", 0.0),
        ("fixed", "X", 0.0),
    }
    (tool,) = problem.tool
    assert tool.velocity == (-3330.0, 0.0)
    assert problem.time.end * 3330.0 == pytest.approx(0.5)
    assert problem.time.integrator is Integrator.IMPLICIT
    assert problem.time.heat_source is HeatSource.EXTRAPOLATED
    assert problem.cut[0].surface == 1.0


def test_a_given_initial_temperature_is_the_body_s(case_file: Path) -> None:
    case, material = load_case(case_file, ["workpiece.temperature=400.0"])
    assert cutting_problem(case, material).body.temperature == 400.0


@pytest.mark.parametrize(
    ("rake", "depth", "touched_height"),
    [
        # The circle's foremost point lies at the height of its centre: 0.9 + 0.025.
        (0.0, 0.1, 0.925),
        (6.0, 0.1, 0.925),
        # The rake face leans forward and meets the corner.
        (-10.0, 0.1, 1.0),
        # The circle's foremost point lies above the top, so the corner touches the circle.
        (0.0, 0.01, 1.0),
        (6.0, 0.01, 1.0),
        (-10.0, 0.01, 1.0),
        # Between the rake face's lower end and the centre of the circle, with a negative rake.
        (-30.0, 0.02, 1.0),
    ],
)
def test_the_tool_first_touches_the_side_at_time_zero(
    rake: float, depth: float, touched_height: float
) -> None:
    tool = starting_tool(cut(rake, depth))
    heights = np.linspace(0.0, 1.0, 20001)
    gap = tool.closest(np.column_stack([np.full_like(heights, 2.0), heights])).gap
    assert abs(gap.min()) < 1e-9
    assert heights[gap.argmin()] == pytest.approx(touched_height, abs=1e-4)


@given(rake=st.floats(-44, 44), depth=st.floats(0.001, 0.5), radius=st.floats(0.002, 0.2))
def test_no_workpiece_lies_inside_the_tool_at_time_zero(rake: float, depth: float, radius: float) -> None:
    tool = starting_tool(cut(rake, depth, radius))
    side = np.column_stack([np.full(2001, 2.0), np.linspace(1.0 - depth, 1.0, 2001)])
    gap = tool.closest(side).gap.min()
    # Round-off, and a point of the circle that falls between two samples.
    assert -1e-12 < gap < (depth / 2000.0) ** 2 / radius + 1e-12


def test_the_tip_circle_reaches_down_to_the_depth_of_cut() -> None:
    tool = starting_tool(cut(rake=6.0, depth=0.1))
    assert tool.centre[1] - tool.tip_radius == pytest.approx(0.9)


def test_spacing_is_fine_at_the_tip_and_grows_away_from_it() -> None:
    mesh, tool = Mesh(shear_zone_size=0.006), starting_tool(cut())
    sizes = size_field(mesh, tool, 0.1, 1.0)
    x, y = tool.centre
    points = np.array(
        [[x, y - tool.tip_radius], [x - 0.08, 0.98], [x + 0.3, 0.9], [x - 0.1, 1.2], [x - 1.9, 0.9]]
    )
    tip, shear, machined, chip, far = sizes(points)
    assert tip == pytest.approx(mesh.tip_size)
    assert shear == pytest.approx(mesh.shear_zone_size)
    assert machined <= mesh.surface_size
    assert chip <= mesh.chip_size
    assert far > 4 * mesh.surface_size


def test_the_chip_s_spacing_does_not_refine_the_uncut_surface_ahead() -> None:
    tool = starting_tool(cut())
    ahead = np.array([[tool.centre[0] - 1.5, 1.0]])
    graded = 0.012 + 0.08 * (1.5 - 0.1 - 0.06)
    assert size_field(Mesh(), tool, 0.1, 1.0)(ahead)[0] == pytest.approx(graded, rel=1e-6)


def test_the_size_field_moves_with_the_tool() -> None:
    tool = starting_tool(cut())
    still = size_field(Mesh(), tool, 0.1, 1.0)
    points = np.random.default_rng(1).uniform([0.0, 0.5], [2.0, 1.3], (200, 2))
    shift = np.array([-0.3, 0.0])
    np.testing.assert_allclose(still.moved(shift)(points + shift), still(points), rtol=1e-12)


def test_the_end_time_is_travel_over_speed(case_file: Path) -> None:
    case, material = load_case(case_file, ["cutting.travel=0.25"])
    problem = cutting_problem(case, material)
    moved = problem.tool[0].at(problem.time.end)
    assert math.isclose(problem.tool[0].shape.centre[0] - moved.centre[0], 0.25, rel_tol=1e-12)


def test_the_readme_s_case_is_valid(tmp_path: Path) -> None:
    readme = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```toml\n(.*?)```", readme, flags=re.DOTALL)
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    assert load_case(tmp_path / "case.toml")[0].tool.tip_radius == 0.025


def test_every_key_of_a_case_is_described() -> None:
    sections = [field.annotation for field in Case.model_fields.values()]
    models = [Case, *(each for each in sections if isinstance(each, type) and issubclass(each, Section))]
    assert len(models) == 9
    undescribed = [
        name for model in models for name, field in model.model_fields.items() if not field.description
    ]
    assert undescribed == []
