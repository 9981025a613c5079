"""Fixtures over small fake datasets."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest


def _load() -> ModuleType:
    """Import ``fakes.py`` by its path: the tests are not a package, and child processes import it the same way."""
    spec = importlib.util.spec_from_file_location("ondisk_fakes", Path(__file__).with_name("fakes.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


_FAKES = _load()


@pytest.fixture(scope="session")
def fakes() -> ModuleType:
    return _FAKES


@pytest.fixture(scope="session")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished dataset of six clips in three worlds that nobody changes."""
    return Path(_FAKES.make(tmp_path_factory.mktemp("pristine") / "dataset", 6))


@pytest.fixture
def dataset(pristine: Path, tmp_path: Path) -> Path:
    """A copy to be damaged."""
    return Path(shutil.copytree(pristine, tmp_path / "dataset"))


@pytest.fixture
def found() -> Callable[..., dict[str, str]]:
    """Verify, and give the findings by file."""
    from scenegen_datasets.verify import verify

    def run(root: Path, **options: object) -> dict[str, str]:
        findings: dict[str, str] = {}
        for finding in verify(root, **options).findings:  # type: ignore[arg-type]
            findings[finding.file] = findings.get(finding.file, "") + finding.reason + "\n"
        return findings

    return run
