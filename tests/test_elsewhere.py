"""What differs between the systems that pfemcut runs on is told or hidden: dolfinx, gmsh, names of packages."""

from __future__ import annotations

import signal
from types import FrameType

import numpy as np
import pytest
from dolfinx import cpp

from meshing.initial import outline_mesh
from pfemcut.fem import runtime
from pfemcut.inputs import UserError
from pfemcut.results.summary import versions


@pytest.mark.parametrize("version", ["0.5.2", "0.9.0", "0.11.0.post0", cpp.__version__])
def test_dolfinx_of_a_release_that_was_tested_is_taken(version: str) -> None:
    runtime.require_tested(version)


@pytest.mark.parametrize("version", ["0.1.0", "0.6.0", "0.10.0", "0.12.0.dev0", "1.5"])
def test_dolfinx_of_another_release_is_refused_in_words(version: str) -> None:
    with pytest.raises(
        UserError, match=rf"^dolfinx {version} is installed; .* 0\.5, 0\.9 and 0\.11 .*install\.md"
    ):
        runtime.require_tested(version)


def test_summaries_name_dolfinx_and_petsc_wherever_they_come_from() -> None:
    assert versions()["dolfinx"].startswith(cpp.__version__)
    assert versions()["petsc4py"][0].isdigit()


def test_meshing_leaves_the_interrupt_key_as_it_was() -> None:
    def noted(_number: int, _frame: FrameType | None) -> None: ...

    before = signal.signal(signal.SIGINT, noted)
    try:
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        outline_mesh(corners, lambda points: np.full(len(points), 0.5), np.zeros(4, dtype=int))
        assert signal.getsignal(signal.SIGINT) is noted
    finally:
        signal.signal(signal.SIGINT, before)
