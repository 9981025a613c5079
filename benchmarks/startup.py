"""How long `scenegen --help` takes: the median of twenty fresh processes.

python benchmarks/startup.py
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

BAR_S = 0.5


def main() -> None:
    seconds = []
    for _ in range(20):
        began = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "scenegen_cli.main", "--help"], check=True, stdout=subprocess.DEVNULL
        )
        seconds.append(time.perf_counter() - began)
    median = statistics.median(seconds)
    print(f"scenegen --help: {1e3 * median:.0f} ms (bar {1e3 * BAR_S:.0f} ms)")
    sys.exit(int(median > BAR_S))


if __name__ == "__main__":
    main()
