"""The pages that are written from the code say what the code says, and the README's table can be filled in."""

from __future__ import annotations

import importlib.util
import json
import re
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
import tomli_w

from pfemcut.case.load import load_case

ROOT = Path(__file__).parent.parent
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "demos").glob("*/README.md")),
    *sorted((ROOT / "tests" / "verification").glob("*/README.md")),
]


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_case_file_reference_is_up_to_date() -> None:
    assert (ROOT / "docs" / "case_file.md").read_text(encoding="utf-8") == script(
        "case_file_reference"
    ).page(), "run python scripts/case_file_reference.py"


def test_materials_page_is_up_to_date() -> None:
    assert (ROOT / "docs" / "materials.md").read_text(encoding="utf-8") == script("materials_page").page(), (
        "run python scripts/materials_page.py"
    )


def test_verification_page_is_up_to_date() -> None:
    assert (ROOT / "docs" / "verification.md").read_text(encoding="utf-8") == script(
        "verification_page"
    ).page(), "run python scripts/verification_page.py"


def test_parallel_page_is_up_to_date() -> None:
    text = (ROOT / "docs" / "parallel.md").read_text(encoding="utf-8")
    assert text == script("parallel_page").page(text), "run python scripts/parallel_page.py"


def test_bounds_of_parallel_steps() -> None:
    """Amdahl's bounds of a step by hand: 60 of 100 ms distributed, of which two ranks take 40."""
    module = script("parallel_page")
    one, two = {"ledger": 0.04, "assembly": 0.06}, {"ledger": 0.03, "assembly": 0.04}
    shares = module.measured_shares(one, two)
    assert shares == {"ledger": 1.0, "assembly": pytest.approx(1.0 / 3.0)}
    assert module.speed_up(one, shares, 2) == pytest.approx(100.0 / 80.0)
    assert module.speed_up(one, module.ideal_shares(one), 6) == pytest.approx(2.0)
    # A phase that takes longer with two ranks is serial, and no more.
    assert module.serial_share(1.0, 1.2) == 1.0


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_inside_the_documentation_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8"))
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_code_named_in_the_documentation_exists(page: Path) -> None:
    names = re.findall(
        r"`((?:pfemcut|meshing|scripts|tests|demos|docs|benchmarks)/[\w/.]+)`",
        page.read_text(encoding="utf-8"),
    )
    missing = [name for name in names if "results" not in name and not (ROOT / name).exists()]
    assert missing == []


EXAMPLES = re.findall(
    r"```toml\n(.*?)```", (ROOT / "docs" / "friction.md").read_text(encoding="utf-8"), re.DOTALL
)


@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
def test_examples_of_friction_are_parts_of_a_valid_case(example: str, tmp_path: Path) -> None:
    case = tomllib.loads((ROOT / "demos" / "aisi4340_rake0" / "case.toml").read_text(encoding="utf-8"))
    for section, values in tomllib.loads(example).items():
        case[section] = {**case.get(section, {}), **values}
    path = tmp_path / "case.toml"
    path.write_text(tomli_w.dumps(case), encoding="utf-8")
    load_case(path)


def test_published_friction_data_can_be_copied() -> None:
    """The coefficients against a second entry in the published units (m/min, and 30 m/min of the first cut)."""
    assert len(EXAMPLES) == 3
    _, titanium, steel = (tomllib.loads(example)["contact"] for example in EXAMPLES)
    assert titanium["friction"] == {"law": "sticking-sliding", "coefficient": 0.18, "shear_limit": 576.0}
    assert titanium["heat_partition"] == pytest.approx(1.0 - 0.55)
    table = steel["friction"]["coefficient"]
    assert [60e-3 * each for each in table["at"]] == pytest.approx([20, 40, 60, 80, 100], rel=2e-4)
    assert table["value"] == [0.421, 0.367, 0.316, 0.270, 0.244]


def test_results_table_shows_recorded_runs_and_says_what_is_missing(tmp_path: Path) -> None:
    for name in ("cut_a", "cut_b"):
        (tmp_path / name / "results").mkdir(parents=True)
        (tmp_path / name / "published.toml").touch()
    figure = {
        "name": "max_temperature",
        "label": "Maximum temperature",
        "unit": "K",
        "published": 810.0,
        "tolerance": 25.0,
        "source": "a paper",
        "computed": 834.0,
        "std": 2.0,
        "difference": 0.0296,
        "verdict": "within tolerance",
    }
    content = {
        "travel": 1.09,
        "steps": 3151,
        "wall_time": 1080.0,
        "steady": True,
        "checks": {"energy_error": 0.006},
        "figures": [figure],
        "sessions": [{"commit": "abc"}, {"commit": "abc"}],
        "recorded": {"commit": "def"},
    }
    (tmp_path / "cut_a" / "results" / "comparison.json").write_text(json.dumps(content), encoding="utf-8")
    module = script("results_table")
    lines = module.table(tmp_path).splitlines()
    assert "| Maximum temperature | 810 ± 25 K | 834 ± 2 K | +3.0% | met |" in lines[2]
    assert "no full run has been recorded yet" in lines[3]
    assert "1.09 mm in 3151 steps and 18 min (steady); energy error 0.006; commit abc." in lines[-1]

    marks = module.MARKS
    text = f"before\n{marks.begin}\nold\n{marks.end}\nafter\n"
    assert marks.filled(text, "new") == f"before\n{marks.begin}\nnew\n{marks.end}\nafter\n"
