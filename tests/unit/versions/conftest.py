"""Hand-made datasets, as for the tests of the files themselves."""

from __future__ import annotations

import importlib.util
import sys
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
