"""The part of a CPU that can change floating-point bytes, and the kernels of linear algebra that go with it."""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path

_LEVELS = {
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "v3": {"avx2", "fma", "bmi2"},
    "v2": {"sse4_2", "popcnt"},
}
"""x86-64 levels, highest first, by flags only they have (x86-64 psABI, section 3.1.1)."""

_KERNELS = {"v4": "Haswell", "v3": "Haswell", "v2": "Nehalem"}
"""Kernels of OpenBLAS that every CPU of a level can run."""


def level() -> str:
    """Machine type and x86-64 level, such as ``"x86_64-v4"``: v3 has AVX2 and FMA, v4 AVX-512."""
    return "-".join(filter(None, (platform.machine().lower(), _level())))


def described(field: str, otherwise: str = "") -> str:
    """What the system says of the first CPU, such as its ``"vendor_id"`` or ``"model name"``."""
    return _described().get(field, otherwise)


def one_kernel() -> dict[str, str]:
    """Environment in which OpenBLAS computes alike on all CPUs of a level.

    Left alone, it chooses among some twenty kernels by the CPU's family and obeys ``OPENBLAS_CORETYPE`` of whoever
    started us; they differ in the last bit of a three-vector's length, hence in which heat class a surface falls.
    """
    kernel = _KERNELS.get(_level())
    return {"OPENBLAS_CORETYPE": kernel} if kernel else {}


def _level() -> str:
    flags = set(described("flags").split())
    return next((name for name, needed in _LEVELS.items() if needed <= flags), "")


@cache
def _described() -> dict[str, str]:
    """Fields of the first processor in ``/proc/cpuinfo``; empty where there is none."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return {}
    lines = (line.partition(":") for line in text.partition("\n\n")[0].splitlines())
    return {name.strip(): value.strip() for name, _, value in lines}
