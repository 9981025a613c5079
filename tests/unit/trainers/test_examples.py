"""Four ways to feed a trainer, run as a reader would run them: losses fall."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"
NAMES = ("feed_pytorch", "feed_lightning", "feed_webdataset", "feed_hugging_face")


@pytest.mark.slow
def test_any_trainer_can_be_fed(toy: Path, tmp_path: Path) -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(NAMES)
    code = (
        f"import json, sys, pathlib, {', '.join(NAMES)}\n"
        f"data = pathlib.Path({str(toy)!r})\n"
        f"json.dump({{m.__name__: m.main(data, 6) for m in ({', '.join(NAMES)})}}, open('losses.json', 'w'))\n"
    )
    environment = {
        **os.environ,
        "PYTHONPATH": str(EXAMPLES),
        "HF_HOME": str(tmp_path / "hf"),
        "HF_HUB_OFFLINE": "1",
        "OMP_NUM_THREADS": "1",
    }
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=1200,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    losses = json.loads((tmp_path / "losses.json").read_text())
    for name in NAMES:
        assert len(losses[name]) == 6 and losses[name][-1] < 0.7 * losses[name][0], (name, losses[name])
