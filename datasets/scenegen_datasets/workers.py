"""What every worker process is started with, whatever the shell of its parent says."""

from __future__ import annotations

from scenegen.foundation import cpu

ENVIRONMENT = {
    **dict.fromkeys(
        ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
    ),
    **cpu.one_kernel(),
    # glibc raises its threshold for returning blocks to the system each time a large one is freed; a fixed one keeps
    # memory flat from world to world (measured: left after release 280-302 MiB without, 284-285 MiB with).
    "MALLOC_MMAP_THRESHOLD_": str(4 << 20),
    "MALLOC_TRIM_THRESHOLD_": str(16 << 20),
    "MALLOC_ARENA_MAX": "1",
}
"""Variables of its environment; set before its interpreter starts, because these are read once."""
