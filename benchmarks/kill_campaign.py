"""Kill a job at random moments, resume it, and compare the bytes with an undisturbed one.

    python benchmarks/kill_campaign.py [--kills 20] [--seed 0]

Kills alternate between the whole process group, the coordinator alone and one worker. Exits with 1 if a byte differs or
a process is left behind.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "system"))
import small


def undisturbed(root: Path) -> float:
    """Make the reference; returns how long that took."""
    began = time.perf_counter()
    job = small.start([*small.render(root), "--no-verify"])
    job.communicate()
    assert job.returncode == 0, "the undisturbed job failed"
    return time.perf_counter() - began


def kill_once(root: Path, victim: str, delay_s: float) -> bool:
    """Start the job, kill after a while; returns whether it was still running then."""
    job = small.start([*small.render(root), "--no-verify"])
    time.sleep(delay_s)
    running = job.poll() is None
    workers = small.children(job.pid)
    if victim == "worker" and workers:
        os.kill(workers[-1], signal.SIGKILL)
    elif running:
        (os.killpg if victim == "group" else os.kill)(job.pid, signal.SIGKILL)
    job.communicate()
    time.sleep(0.5)
    left = [pid for pid in workers if small.alive(pid)]
    if left:
        sys.exit(f"processes left behind: {left}")
    return running


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    with tempfile.TemporaryDirectory() as scratch:
        reference, root = Path(scratch) / "a" / "tiny", Path(scratch) / "b" / "tiny"
        seconds = undisturbed(reference)
        landed = jobs = 0
        while landed < options.kills:
            victim = ("group", "coordinator", "worker")[landed % 3]
            landed += kill_once(root, victim, rng.uniform(0.3, seconds))
            if (root / "dataset.json").exists():  # it got through: begin another
                undisturbed(root)
                jobs += 1
                if small.tree(root) != small.tree(reference):
                    sys.exit(f"after {landed} kills the bytes differ: compare {root} and {reference}")
                small.remove(root)
        undisturbed(root)
        differs = small.tree(root) != small.tree(reference)
        print(f"{landed} kills over {jobs + 1} datasets: {'bytes DIFFER' if differs else 'byte-identical'}")
        sys.exit(int(differs))


if __name__ == "__main__":
    main()
