"""A short soak: what a step leaves behind in memory shows after a few hundred (the long one is in verification)."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from pfemcut.results.history import read_table

ROOT = Path(__file__).resolve().parent.parent
SETTLED, STEPS = 100, 300
LIMIT = 0.03  # of some 200 MB: 30 kB a step; the matrix of one step alone has 100 kB
RUN = """
from pathlib import Path
from tests.verification.soak.sampled import sampled_run
sampled_run(Path("tests/verification/soak/case.toml"), Path({directory!r}), 50, ["cutting.travel=0.0105"])
"""


@pytest.mark.skipif(
    not Path("/proc/self/statm").exists(), reason="resident memory is read from Linux's /proc"
)
def test_memory_stays_flat_over_hundreds_of_steps(tmp_path: Path) -> None:
    """In a process of its own, whose memory holds nothing of other tests."""
    subprocess.run(
        [sys.executable, "-c", RUN.format(directory=str(tmp_path))],
        cwd=ROOT,
        check=True,
        timeout=600,
        capture_output=True,
    )
    samples = read_table(tmp_path / "memory.csv")
    late = samples["step"] >= SETTLED
    resident = samples["resident_megabytes"][late]
    assert samples["step"][-1] >= STEPS
    assert resident.max() / resident[0] - 1.0 < LIMIT
    assert samples["halved_steps"][-1] == 0
