"""One finished dataset for all system tests of the main path."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def finished_dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sixteen pairs, made by two processes and verified by the command itself."""
    import small

    from scenegen_cli.main import main

    root = tmp_path_factory.mktemp("reference") / "tiny"
    assert main(small.render(root)) == 0
    return root
