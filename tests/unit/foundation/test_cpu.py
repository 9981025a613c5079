"""Which CPU it is, and that linear algebra does not depend on more than its class."""

import os
import sys
from pathlib import Path

import pytest

from scenegen.foundation import cpu
from scenegen.foundation.pool import Done, Pool, Task


def test_the_level_of_a_cpu_follows_from_its_flags(monkeypatch: pytest.MonkeyPatch) -> None:
    """A level needs all of its flags; a machine without any is named alone, and gets no kernel."""
    v4 = "fpu sse4_2 popcnt avx2 fma bmi2 avx512f avx512bw avx512cd avx512dq avx512vl"
    for flags, level, kernel in (
        (v4, "x86_64-v4", "Haswell"),
        (v4.replace("avx512vl", ""), "x86_64-v3", "Haswell"),
        ("fpu sse4_2 popcnt avx2", "x86_64-v2", "Nehalem"),
    ):
        monkeypatch.setattr(cpu, "_described", lambda flags=flags: {"flags": flags})
        monkeypatch.setattr("platform.machine", lambda: "x86_64")
        assert cpu.level() == level
        assert cpu.one_kernel() == {"OPENBLAS_CORETYPE": kernel}
    monkeypatch.setattr(cpu, "_described", dict)
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    assert cpu.level() == "aarch64"
    assert cpu.one_kernel() == {}


def test_the_shell_of_the_parent_does_not_choose_the_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers compute with the kernel of their CPU's class, whatever variable the job was started with."""
    monkeypatch.setattr(cpu, "_described", lambda: {"flags": "sse4_2 popcnt"})
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Zen")
    paths = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    with Pool("cpu_tasks:factory", {}, 1, environment={**cpu.one_kernel(), "PYTHONPATH": paths}) as pool:
        (done,) = (event for event in pool.run([Task("a", "a", {})]) if isinstance(event, Done))
    assert done.value == {"kernel": "Nehalem"}
