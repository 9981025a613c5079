"""Hand-made datasets, as for the tests of the files themselves, and a way to die in the middle."""

from __future__ import annotations

import importlib.util
import itertools
import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest


def _load() -> ModuleType:
    path = Path(__file__).parents[1] / "ondisk" / "fakes.py"
    spec = importlib.util.spec_from_file_location("versions_fakes", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


_FAKES = _load()


@pytest.fixture(scope="session")
def fakes() -> ModuleType:
    return _FAKES


class Killed(BaseException):
    """Death at a call that touches the disk."""


def run_until(step: int, act: Callable[[], object]) -> bool:
    """Run `act`, and at its `step`-th call that touches the disk die there; returns whether it died.

    From the death on every such call fails, so that no clean-up changes anything, as after SIGKILL. The lock's
    descriptor stays open in this process: go on in a copy of the directory.
    """
    steps = itertools.count(1)
    dead = False

    def counted(call: Callable[..., object]) -> Callable[..., object]:
        def wrapper(*args: object, **kwargs: object) -> object:
            nonlocal dead
            dead = dead or next(steps) >= step
            if dead:
                raise Killed
            return call(*args, **kwargs)

        return wrapper

    with pytest.MonkeyPatch.context() as patch:
        for name in ("write", "fsync", "replace", "unlink", "link", "mkdir"):
            patch.setattr(os, name, counted(getattr(os, name)))
        try:
            act()
        except Killed:
            return True
    assert not dead
    return False


@pytest.fixture
def dies() -> Callable[[int, Callable[[], object]], bool]:
    """``dies(step, act)``: run `act` and die at its `step`-th call that touches the disk; False if it lived."""
    return run_until
