"""Fixtures over small fake datasets."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

import fakes as _fakes


@pytest.fixture(scope="session")
def fakes() -> ModuleType:
    return _fakes


@pytest.fixture(scope="session")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished dataset of six clips in three worlds that nobody changes."""
    return Path(_fakes.make(tmp_path_factory.mktemp("pristine") / "dataset", 6))


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
