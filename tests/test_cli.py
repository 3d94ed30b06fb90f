"""The command line: exit statuses, one clear line for each mistake, and a quick start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from meshing.sizes import Box, SizeField, SizeZone
from pfemcut.case.check import particle_estimate
from pfemcut.cli.main import status
from pfemcut.inputs import InputError
from pfemcut.materials.load import library_names
from pfemcut.method import RunStopped
from pfemcut.output.directory import OutputError
from pfemcut.results.checkpoint import CheckpointError
from pfemcut.results.summary import Summary

DEMO = Path(__file__).parent.parent / "demos" / "aisi4340_demo" / "case.toml"
CASE = """\
title = "small cut"
[workpiece]
length = 2.0
height = 1.0
material = "aisi4340"
[tool]
tip_radius = 0.025
[cutting]
speed = 3330.0
depth = 0.1
travel = 0.5
[time]
step = 1e-7
[output]
directory = "DIRECTORY"
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("DIRECTORY", str(tmp_path / "out")), encoding="utf-8")
    return path


class Driver(ModuleType):
    """Stands in for ``pfemcut.driver``: remembers its call and raises what it is told to."""

    def __init__(self, raises: Exception | None = None, finished: bool = True) -> None:
        super().__init__("pfemcut.driver")
        self.raises = raises
        self.finished = finished
        self.calls: list[tuple[Any, ...]] = []

    def run_case(
        self,
        case: Any,
        material: Any,
        directory: Path,
        *,
        base_directory: Path,
        resume: bool,
        overwrite: bool,
    ) -> Summary:
        self.calls.append((case, material, directory, resume, overwrite))
        if self.raises is not None:
            raise self.raises
        return Summary(
            title=case.title,
            finished=self.finished,
            ending="reached its final time",
            steady=True,
            window=(0.4, 0.5),
            steps=1502,
            travel=0.5,
            wall_time=12.0,
            figures={
                "cutting_force": {"mean": 151.25, "std": 1.5, "unit": "N/mm"},
                "area_drift": {"value": 0.001, "unit": "-"},
            },
            ledgers={},
            seconds_per_step={},
            versions={},
            warnings=("the chip is short",),
        )


def installed(monkeypatch: pytest.MonkeyPatch, driver: Driver) -> Driver:
    monkeypatch.setitem(sys.modules, "pfemcut.driver", driver)
    return driver


def test_run_hands_the_case_to_the_driver(
    monkeypatch: pytest.MonkeyPatch, case_file: Path, tmp_path: Path
) -> None:
    driver = installed(monkeypatch, Driver())
    assert status(["run", str(case_file)]) == 0
    case, material, *rest = driver.calls[0]
    assert (case.cutting.travel, material.name, *rest) == (0.5, "AISI 4340", tmp_path / "out", False, False)


def test_options_of_run_override_the_case(
    monkeypatch: pytest.MonkeyPatch, case_file: Path, tmp_path: Path
) -> None:
    driver = installed(monkeypatch, Driver())
    other = tmp_path / "other"
    options = [
        "-o",
        str(other),
        "--travel",
        "0.25 mm",
        "--set",
        "tool.rake=6",
        "--set",
        "mesh.insert=false",
        "--resume",
    ]
    assert status(["run", str(case_file), *options]) == 0
    case, _, directory, resume, overwrite = driver.calls[0]
    assert (case.cutting.travel, case.tool.rake, case.mesh.insert) == (0.25, 6.0, False)
    assert directory == other
    assert case.output.directory == str(other)
    assert (resume, overwrite) == (True, False)


def test_overwrite_reaches_the_driver_and_excludes_resume(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], case_file: Path
) -> None:
    driver = installed(monkeypatch, Driver())
    assert status(["run", str(case_file), "--overwrite"]) == 0
    assert driver.calls[0][3:] == (False, True)
    assert status(["run", str(case_file), "--overwrite", "--resume"]) == 2
    assert "exclude each other" in capsys.readouterr().err
    assert len(driver.calls) == 1


def test_a_finished_run_prints_its_figures(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], case_file: Path
) -> None:
    installed(monkeypatch, Driver())
    assert status(["run", str(case_file)]) == 0
    printed = capsys.readouterr().out
    for words in ("small cut: reached its final time", "1502 steps", "0.4 to 0.5 mm, steady"):
        assert words in printed
    assert [line.split() for line in printed.splitlines() if line.startswith("  ")] == [
        ["cutting_force", "151.2", "+-", "1.5", "N/mm"],
        ["area_drift", "0.001"],
    ]
    assert "warning: the chip is short" in printed


def test_a_run_without_valid_figures_is_no_success(monkeypatch: pytest.MonkeyPatch, case_file: Path) -> None:
    installed(monkeypatch, Driver(finished=False))
    assert status(["run", str(case_file)]) == 1


def test_overrides_of_one_run_do_not_leak_into_the_next(
    monkeypatch: pytest.MonkeyPatch, case_file: Path
) -> None:
    driver = installed(monkeypatch, Driver())
    status(["run", str(case_file), "--set", "tool.rake=6"])
    status(["run", str(case_file)])
    assert [call[0].tool.rake for call in driver.calls] == [6.0, 0.0]


@pytest.mark.parametrize(
    ("raised", "code", "line"),
    [
        (RunStopped("step 7: no convergence"), 1, "pfemcut: run stopped: step 7: no convergence\n"),
        (InputError(["a problem"]), 2, "pfemcut: a problem\n"),
        (
            OutputError("out: holds the results of another run"),
            2,
            "pfemcut: out: holds the results of another run\n",
        ),
        (CheckpointError("checkpoint.h5: another case"), 2, "pfemcut: checkpoint.h5: another case\n"),
    ],
)
def test_a_run_that_stops_says_why_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    case_file: Path,
    raised: Exception,
    code: int,
    line: str,
) -> None:
    installed(monkeypatch, Driver(raised))
    assert status(["run", str(case_file)]) == code
    assert capsys.readouterr().err == line


def test_a_defect_of_the_program_is_not_dressed_up_as_bad_input(
    monkeypatch: pytest.MonkeyPatch, case_file: Path
) -> None:
    installed(monkeypatch, Driver(ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        status(["run", str(case_file)])


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("tool.rak=1.0", "[tool] rak: unknown key; did you mean 'rake'?"),
        ("cutting.depth=-0.1", "[cutting] depth: given -0.1"),
        ("cutting.depth=nan", "[cutting] depth: given nan"),
        ("cutting.depth=deep", "[cutting] depth: given 'deep'"),
        ("workpiece.material=granite", "unknown material 'granite'"),
        ("depth", "--set: given 'depth', must be section.key=value"),
    ],
)
def test_bad_input_is_one_line_on_stderr_and_status_2(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    case_file: Path,
    command: str,
    override: str,
    words: str,
) -> None:
    driver = installed(monkeypatch, Driver())
    assert status([command, str(case_file), "--set", override]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert words in line
    assert not driver.calls


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "no command given"),
        (["cut"], "No such command 'cut'"),
        (["run"], "Missing argument 'CASE.toml'"),
        (["check", "nowhere.toml"], "nowhere.toml: no such file"),
        (["check", "."], "is a directory"),
        (["run", str(DEMO), "--travel", "far"], "[cutting] travel: given 'far', must be a length"),
        (["run", "nowhere.toml", "--colour"], "--colour"),
        (["report", "nowhere"], "nowhere: no results here"),
        (["materials", "aisi434"], "did you mean 'aisi4340'?"),
    ],
)
def test_a_wrong_command_line_is_one_line_and_status_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert status(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line


def test_check_prints_the_main_figures(capsys: pytest.CaptureFixture[str], case_file: Path) -> None:
    assert status(["check", str(case_file)]) == 0
    printed = capsys.readouterr().out
    for words in ("small cut", "AISI 4340", "about 1502 of 1e-07 s (0.333 um each)", "particles"):
        assert words in printed
    assert "warning" not in printed


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("mesh.tip_size=0.009", "tip_size = 0.009 mm resolves the tip radius of 0.025 mm poorly"),
        ("time.step=4e-7", "[time] step moves the tool by 0.00133 mm"),
        ("cutting.depth=0.02", "below the tip radius"),
        ("cutting.travel=0.2", "too short for steady means"),
        ("cutting.travel=1.9", "five depths of cut from the held side"),
    ],
)
def test_check_warns_of_unwise_choices(
    capsys: pytest.CaptureFixture[str], case_file: Path, override: str, words: str
) -> None:
    assert status(["check", str(case_file), "--set", override]) == 0
    warned = [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning: ")]
    assert any(words in line for line in warned)


def test_materials_lists_names_and_prints_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["materials"]) == 0
    names = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert names == library_names()
    assert status(["materials", "voce_steel"]) == 0
    printed = capsys.readouterr().out
    assert "yield_stress = 450.0  # Initial yield stress sigma_0 (MPa)" in printed
    assert 'density = "the paper, Table 1"' in printed


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["--version"]) == 0
    assert capsys.readouterr().out.startswith("pfemcut ")


@pytest.mark.parametrize("variable", ["OMPI_COMM_WORLD_RANK", "PMI_RANK"])
def test_only_rank_0_speaks(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], variable: str
) -> None:
    for rank, lines in (("1", 0), ("0", 1)):
        monkeypatch.setenv(variable, rank)
        assert status(["check", "nowhere.toml"]) == 2
        assert len(capsys.readouterr().err.splitlines()) == lines


def test_python_m_pfemcut_checks_a_case_without_slow_imports(case_file: Path) -> None:
    script = (
        "import runpy, sys\n"
        f"sys.argv = ['pfemcut', 'check', {str(case_file)!r}]\n"
        "try:\n    runpy.run_module('pfemcut', run_name='__main__')\n"
        "except SystemExit as stop:\n    print('status', stop.code)\n"
        "slow = {'dolfinx', 'mpi4py', 'matplotlib', 'scipy', 'numba'}\n"
        "print('slow', sorted(slow & set(sys.modules)))\n"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "status 0" in result.stdout
    assert "slow []" in result.stdout


def test_bad_input_of_the_real_program_has_no_traceback(case_file: Path) -> None:
    command = [sys.executable, "-m", "pfemcut", "run", str(case_file), "--set", "cutting.depth=-1"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_particle_estimate_of_a_uniform_spacing_is_the_triangular_lattice_s() -> None:
    count = particle_estimate(SizeField((), 0.1), 4.0, 2.0)
    assert count == pytest.approx(4.0 * 2.0 / (0.75**0.5 * 0.01) + 12.0 / 0.2, rel=1e-9)


def test_particle_estimate_resolves_a_small_fine_zone() -> None:
    zone = SizeZone(Box((3.0, 1.0), (3.25, 1.25)), 0.002, 10.0)
    count = particle_estimate(SizeField((zone,), 0.5), 4.0, 2.0)
    assert count == pytest.approx(0.25**2 / (0.75**0.5 * 0.002**2), rel=0.1)
