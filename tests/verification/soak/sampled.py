"""A run through the driver, outputs included, with the process's resident memory sampled on the way.

Samples go to a file as they come, so that a soak that was stopped leaves what it found.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pfemcut.case.load import load_case, resolved_toml
from pfemcut.case.translate import problem_of
from pfemcut.driver import MethodFactory, run_problem
from pfemcut.method import Frame, Measures
from pfemcut.pfem.method import PfemMethod
from pfemcut.results.history import TableWriter, read_table
from pfemcut.results.summary import Summary

Sample = dict[str, float]


class SampledMethod:
    """The PFEM, which notes memory and pace every so many steps.

    Parameters
    ----------
    method
        The method that does the work.
    every
        Steps between samples.
    table
        Where samples go.
    """

    def __init__(self, method: PfemMethod, every: int, table: TableWriter) -> None:
        self._method = method
        self._every = every
        self._table = table
        self._slowest = 0.0
        self._sampled_at = time.perf_counter()

    @property
    def finished(self) -> bool:
        return self._method.finished

    def advance(self) -> None:
        begun = time.perf_counter()
        self._method.advance()
        self._slowest = max(self._slowest, time.perf_counter() - begun)
        step = self._method.current.clock.step
        if step % self._every == 0:
            self._sample(step)

    def measure(self) -> Measures:
        return self._method.measure()

    def own_measures(self) -> Mapping[str, float]:
        return self._method.own_measures()

    def timing(self) -> Mapping[str, float]:
        return self._method.timing()

    def frame(self) -> Frame:
        return self._method.frame()

    def state(self) -> Mapping[str, NDArray[Any]]:
        return self._method.state()

    def _sample(self, step: int) -> None:
        now = time.perf_counter()
        state = self._method.current
        self._table.append(
            {
                "step": step,
                "travel": self._method.measure().travel,
                "particles": len(state.mesh.points),
                "resident_megabytes": resident_megabytes(),
                "milliseconds_per_step": 1e3 * (now - self._sampled_at) / self._every,
                "slowest_step_milliseconds": 1e3 * self._slowest,
                "halved_steps": state.ledger.step_cuts,
            }
        )
        self._slowest, self._sampled_at = 0.0, now


def resident_megabytes() -> float:
    """Memory of this process that is in RAM, from Linux's /proc."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def sampled_run(
    case_file: Path, directory: Path, every: int, overrides: Sequence[str] = ()
) -> tuple[Summary, list[Sample]]:
    """Run a case into ``directory``, whose earlier results are replaced, with a sample every so many steps.

    Returns
    -------
    summary
        The run's summary.
    samples
        Rows of ``memory.csv`` in the directory.
    """
    case, material = load_case(case_file, overrides)
    problem = problem_of(case, material, case_file.parent)
    directory.mkdir(parents=True, exist_ok=True)
    path = directory / "memory.csv"
    path.unlink(missing_ok=True)
    with TableWriter(path) as table:
        factory = MethodFactory(
            start=lambda: SampledMethod(PfemMethod.start(problem), every, table),
            restore=lambda state: SampledMethod(PfemMethod.restore(problem, state), every, table),
        )
        inputs = resolved_toml(case, material)
        summary = run_problem(problem, factory, directory, case.output, inputs=inputs, overwrite=True)
    columns = read_table(path)
    return summary, [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
