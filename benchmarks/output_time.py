"""What writing costs a step: history rows, fields and checkpoints, from the times that a run noted.

    python benchmarks/output_time.py DIR [--output FILE]

DIR holds a finished run that writes a history row every step: `python benchmarks/seconds_per_mm.py --only 6k` leaves
one in out/bench/6k_2. The times are those that the step waits, under mpirun with all ranks. The first step is left out.
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.results.history import read_table
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

OUTPUT = ROOT / "benchmarks" / "results" / "output_time.json"


def costs(directory: Path) -> dict[str, Any]:
    """Seconds of a row, of fields and of a checkpoint (medians), and their shares of the run."""
    controls = tomllib.loads((directory / "inputs.resolved.toml").read_text(encoding="utf-8"))["output"]
    timing = {name: values[1:] for name, values in read_table(directory / "timing.csv").items()}
    nodes = read_table(directory / "history.csv")["nodes"]
    step, output, total = timing["step"], timing["output"], timing["total"]
    fields = step % controls["every"] == 0
    checkpoint = step % controls["checkpoint_every"] == 0
    row = float(np.median(output[~fields & ~checkpoint]))
    frame = float(np.median(output[fields & ~checkpoint])) - row
    return {
        "particles": [int(nodes.min()), int(nodes.max())],
        "steps": len(step),
        "step_seconds": float(total.mean()),
        "row_seconds": row,
        "fields_seconds": frame,
        "checkpoint_seconds": float(np.median(output[fields & checkpoint])) - row - frame,
        "fields_every": controls["every"],
        "checkpoint_every": controls["checkpoint_every"],
        "share_of_rows": row * len(step) / float(total.sum()),
        "share_of_files": float((output[fields | checkpoint] - row).sum() / total.sum()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("directory", type=Path, metavar="DIR")
    parser.add_argument("--output", type=Path, default=OUTPUT)
    options = parser.parse_args()
    found = costs(options.directory)
    write_json(options.output, {**provenance(), **found})
    print(
        f"a step {1e3 * found['step_seconds']:.0f} ms; a row {1e3 * found['row_seconds']:.1f} ms, "
        f"fields {1e3 * found['fields_seconds']:.0f} ms, a checkpoint {1e3 * found['checkpoint_seconds']:.0f} ms; "
        f"rows {found['share_of_rows']:.1%} and files {found['share_of_files']:.2%} of the run"
    )
    print(f"results  {options.output}")


if __name__ == "__main__":
    main()
