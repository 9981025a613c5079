from __future__ import annotations

import stat
import sys
from pathlib import Path

import pytest

from scenegen_render import backend
from scenegen_render.doctor import self_check


def test_a_healthy_renderer_is_called_healthy_and_described():
    report = self_check()
    assert report.healthy and report.problem == "" and report.advice == ""
    assert report.backend is not None and report.backend.fingerprint() == backend.describe().fingerprint()
    assert report.radiance_error < 1e-5 and report.depth_error < 1e-6


def test_a_missing_library_is_told_in_one_line_with_what_to_do(monkeypatch):
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nowhere/libLLVM.so")
    report = self_check()
    assert not report.healthy and report.backend is None
    assert "/nowhere/libLLVM.so" in report.problem and "\n" not in report.problem
    assert "DRJIT_LIBLLVM_PATH" in report.advice


@pytest.mark.parametrize(
    ("script", "told", "patience_s"),
    [
        ("kill -ABRT $$", "SIGABRT", 60.0),
        ("echo broken wheel >&2; exit 3", "broken wheel", 60.0),
        ("exec sleep 1000", "did not answer", 1.0),
    ],
)
def test_the_check_survives_whatever_happens_to_its_child(
    monkeypatch, tmp_path: Path, script: str, told: str, patience_s: float
):
    fake = tmp_path / "python"
    fake.write_text(f"#!/bin/sh\n{script}\n")
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(sys, "executable", str(fake))
    report = self_check(timeout_s=patience_s)
    assert not report.healthy and told in report.problem and report.advice


def test_threads_never_exceed_the_affinity():
    assert backend.set_threads(10_000) == backend.affinity()
    assert backend.set_threads(1) == 1
    assert backend.set_threads(0) == 1


def test_the_fingerprint_names_everything_that_changes_bytes():
    found = backend.describe().fingerprint()
    assert found["mitsuba"] == "3.9.1" and found["drjit"] == "1.5.0"
    assert {"variant", "llvm", "cpu_class", "numpy", "OpenEXR"} <= set(found)
    assert all(value and value != "absent" for value in found.values())
