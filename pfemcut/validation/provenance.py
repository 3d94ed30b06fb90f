"""Where a result comes from: command, date, program and machine, so that it can be trusted and repeated."""

from __future__ import annotations

import os
import platform
import shlex
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pfemcut.launcher import processes
from pfemcut.results.summary import versions

ROOT = Path(__file__).resolve().parent.parent.parent
"""The checkout."""


def provenance() -> dict[str, Any]:
    """Command, date, version, commit and the machine's figures (no names of hosts or users)."""
    return {
        "command": command(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": versions().get("pfemcut", "unknown"),
        **commit(),
        "machine": machine(),
    }


def command() -> str:
    """The command line, with paths relative to the checkout."""
    words = [_relative(word) for word in sys.argv]
    return shlex.join(["python", *words])


def commit() -> dict[str, Any]:
    """Commit of the checkout, and whether files that it tracks were changed since."""
    revision = _git("rev-parse", "--short=12", "HEAD")
    changed = _git("status", "--porcelain", "--untracked-files=no", "--", "pfemcut", "meshing")
    return {"commit": revision or "unknown", "modified": bool(changed)}


def machine() -> dict[str, Any]:
    """Figures of the machine that times depend on."""
    return {
        "cores": os.cpu_count(),
        "processor": _processor(),
        "memory_gigabytes": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "omp_threads": os.environ.get("OMP_NUM_THREADS", "not set"),
        "ranks": processes(),
    }


def _relative(word: str) -> str:
    """``word``, as a path in the checkout or, outside of it, without the machine's folders."""
    path = Path(word)
    if path.exists() and path.resolve().is_relative_to(ROOT):
        return str(path.resolve().relative_to(ROOT))
    return path.name if path.is_absolute() else word


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, timeout=20
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
