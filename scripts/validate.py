"""Runs published cases, studies and verification (`make validate`), a few at a time, and writes what they found.

    python scripts/validate.py [-j 2] [--overwrite] [NAME ...]

Each script of demos/*/, and tests/verification/*/verify.py, runs in its own process with one BLAS thread. Those of the
demos run with --resume, so what is finished costs seconds and what was interrupted goes on. Logs are in out/validate.
At the end the README's table, docs/verification.md and docs/validation.md are written. NAME is part of a script's path
(softening, rake6/run, necking). The status is 1 if a script failed or missed its target.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOGS = ROOT / "out" / "validate"
LONGEST_FIRST = ("voce_rake0/run", "voce_rake0/softening")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the scripts and return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-j", "--jobs", type=int, default=1, metavar="N", help="scripts at a time")
    parser.add_argument("--overwrite", action="store_true", help="run everything again from the start")
    parser.add_argument("--list", action="store_true", help="list the scripts")
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these")
    options = parser.parse_args(arguments)
    scripts = chosen(options.names)
    if not scripts:
        parser.error(f"no script's path has {' or '.join(options.names)} in it")
    if options.list:
        print("\n".join(str(script.relative_to(ROOT)) for script in scripts))
        return 0
    how = "--overwrite" if options.overwrite else "--resume"
    LOGS.mkdir(parents=True, exist_ok=True)
    running: list[subprocess.Popen[bytes]] = []
    with ThreadPoolExecutor(max(options.jobs, 1)) as pool:
        try:
            results = list(pool.map(lambda script: run(script, how, running), scripts))
        except KeyboardInterrupt:
            # The runs write a checkpoint and end; the next `make validate` goes on from there.
            pool.shutdown(wait=False, cancel_futures=True)
            for process in running:
                if process.poll() is None:
                    process.send_signal(signal.SIGINT)
            for process in running:
                process.wait()
            return 130
    pages = (
        "results_table",
        "predictions_tables",
        "particles_tables",
        "verification_page",
        "validation_page",
    )
    for page in pages:
        subprocess.run([sys.executable, str(ROOT / "scripts" / f"{page}.py")], check=True)
    return max(results)


def chosen(names: Sequence[str]) -> list[Path]:
    """Scripts whose path has one of ``names`` in it, all without names; the longest first."""
    scripts = [
        *sorted((ROOT / "demos").glob("*/*.py")),
        *sorted((ROOT / "tests" / "verification").glob("*/verify.py")),
    ]
    scripts = [script for script in scripts if not names or any(name in str(script) for name in names)]
    return sorted(scripts, key=lambda script: not any(name in str(script) for name in LONGEST_FIRST))


def run(script: Path, how: str, running: list[subprocess.Popen[bytes]]) -> int:
    """Run one script with its output in a log; 0 or 1."""
    name = f"{script.parent.name}/{script.stem}"
    log = LOGS / f"{name.replace('/', '.')}.log"
    begun = time.monotonic()
    print(f"{name}: started, log in {log.relative_to(ROOT)}", flush=True)
    with log.open("ab") as file:
        process = subprocess.Popen(
            command(script, how),
            cwd=ROOT,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            # Ctrl-C reaches it through us, once: a second signal would kill it before its checkpoint.
            start_new_session=True,
        )
        running.append(process)
        status = process.wait()
    verdict = {0: "done", 1: "stopped or missed a target", 2: "bad input"}.get(
        status, f"exit status {status}"
    )
    print(f"{name}: {verdict} after {(time.monotonic() - begun) / 60.0:.1f} min", flush=True)
    return int(status != 0)


def command(script: Path, how: str) -> list[str]:
    """How to start a script; those of the verification are modules, minutes long, and always run whole."""
    inside = script.relative_to(ROOT)
    if inside.parts[0] == "tests":
        return [sys.executable, "-m", ".".join(inside.with_suffix("").parts)]
    return [sys.executable, str(script), how]


if __name__ == "__main__":
    sys.exit(main())
