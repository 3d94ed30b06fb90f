"""Feed mutated inputs and damaged folders to everything that reads what users give, and count what comes of it.

    python scripts/fuzz_inputs.py --count 12000 --seed 1 --record benchmarks/results/fuzz_inputs.json
    python scripts/fuzz_inputs.py --what folders --count 1000 --record benchmarks/results/fuzz_folders.json

Each input is valid but for one to three mutations: of the text (bytes flipped, cut, doubled, swapped), of values (wrong
types, huge, negative, nan, unicode, deep nesting, very long), of keys, of ``--set`` options, of numbers in mesh files,
and of the bits of checkpoints. It must be accepted with its values unchanged, or refused with a :class:`UserError` of
at least one line. A third outcome is a defect: another exception, more than the limit of time, a value that is not the
given one, or a checkpoint that reads as something else than was written. Nothing is simulated: cases are loaded,
checked, translated to a problem and written out again.

Folders are those that a small cut leaves, with one to three files cut short, changed, emptied or gone, which the
commands report, compare, watch, converge and run --resume then read. Ends with status 1 if there was a defect.
"""

from __future__ import annotations

import argparse
import json
import resource
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from fuzzing import folders, inputs

from pfemcut.validation.provenance import provenance

MEMORY = 4 << 30
"""Bytes that the process may use."""


class Fuzzer(Protocol):
    """Makes inputs and judges what comes of them."""

    def outcome(self, number: int) -> tuple[str, str, str]:
        """Return the kind of input ``number``, the outcome (accepted, refused or a defect) and its details."""


KINDS: dict[str, Callable[[int, Path], Fuzzer]] = {"inputs": inputs.Inputs, "folders": folders.Folders}
LIMITS = {"inputs": inputs.LIMIT, "folders": folders.LIMIT}


def fuzz(
    seed: int, numbers: range, tell: Callable[[str], object] = print, what: str = "inputs"
) -> Counter[tuple[str, str]]:
    """Try the inputs ``numbers`` of a seed; count outcomes by kind, and tell of each defect."""
    counts: Counter[tuple[str, str]] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        fuzzer = KINDS[what](seed, Path(folder))
        for number in numbers:
            kind, outcome, details = fuzzer.outcome(number)
            counts[kind, outcome] += 1
            if outcome.startswith("defect"):
                tell(f"input {number} of seed {seed} ({kind}): {outcome}\n{details}")
    return counts


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--what", choices=list(KINDS), default="inputs")
    parser.add_argument("--count", type=int, default=12_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--record", type=Path, help="JSON file for the counts")
    given = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    counts = fuzz(given.seed, range(given.first, given.first + given.count), what=given.what)
    table: dict[str, dict[str, int]] = {}
    for (kind, outcome), count in sorted(counts.items()):
        table.setdefault(kind, {})[outcome] = count
    totals = Counter[str]()
    for (_, outcome), count in counts.items():
        totals[outcome] += count
    print(json.dumps({"totals": totals, **table}, indent=2))
    if given.record:
        limit = LIMITS[given.what]
        content: dict[str, Any] = {"inputs": given.count, "seed": given.seed, "limit_seconds": limit}
        content["totals"] = dict(sorted(totals.items()))
        content |= {"by_kind": table, "provenance": provenance()}
        given.record.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", "utf-8")
    return int(any(outcome.startswith("defect") for outcome in totals))


if __name__ == "__main__":
    raise SystemExit(main())
