"""A job small enough for tests: a small city, tiny pictures, four short flights."""

import hashlib
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path

FLAGS = [
    *("--size", "64x64"),
    *("--clips-per-world", "4"),
    *("--pairs-per-clip", "4"),
    *("--city.extent-m", "400"),
    *("--exposure.directions", "32"),
    *("--exposure.sun-step-min", "120"),
]
PAIRS = 16


def render(out: Path, *, pairs: int = PAIRS, jobs: int = 2, more: tuple[str, ...] = ()) -> list[str]:
    """Arguments of the job."""
    return ["render", "--pairs", str(pairs), "--out", str(out), "--jobs", str(jobs), *FLAGS, *more]


def start(arguments: list[str]) -> subprocess.Popen[str]:
    """Run `scenegen` in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "scenegen_cli.main", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        process_group=0,
    )


def tree(root: Path) -> dict[str, str]:
    """Path to SHA-256 of every file of a dataset but the run log."""
    files = (path for path in sorted(root.rglob("*")) if path.is_file() and path.name != "run.log.jsonl")
    return {str(p.relative_to(root)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def children(pid: int) -> list[int]:
    """Child processes, by the kernel's own list."""
    path = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(word) for word in path.read_text().split()] if path.exists() else []


def alive(pid: int) -> bool:
    """Whether a process runs (a zombie does not)."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False


def until(condition: Callable[[], object], patience_s: float = 300.0) -> bool:
    """Wait until something holds, as long as a busy machine may take; whether it does."""
    deadline = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


def gone(pids: Iterable[int]) -> bool:
    """Whether processes end by themselves."""
    return until(lambda: not any(map(alive, pids)), 60.0)


def starts(root: Path) -> int:
    """How often making clips was begun, as the log of a dataset tells."""
    log = root / "run.log.jsonl"
    return log.read_text().count('"event": "start"') if log.exists() else 0


def remove(root: Path) -> None:
    """Delete a dataset."""
    shutil.rmtree(root)
