"""`scenegen sense` on a rendered dataset: the same camera gives the same bytes, others a dataset that verifies."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenegen_cli.main import main
from scenegen_datasets import PairDataset
from scenegen_datasets.verify import verify

TRUTH = ("radiance", "depth", "temperature", "semantic", "instance", "material", "flow", "covisible")


def samples(root: Path, *layers: str) -> list[dict[str, Any]]:
    return list(PairDataset(root, layers=layers))


def test_the_same_camera_gives_the_same_clips(finished_dataset: Path, tmp_path: Path) -> None:
    out = tmp_path / "again"
    assert main(["sense", str(finished_dataset), "--out", str(out), "--jobs", "1"]) == 0
    for shard in sorted(finished_dataset.rglob("*.tar")):
        assert (out / shard.relative_to(finished_dataset)).read_bytes() == shard.read_bytes()
    told = [json.loads((root / "dataset.json").read_bytes()) for root in (finished_dataset, out)]
    assert told[0]["content_id"] == told[1]["content_id"] and told[0]["recipe_id"] != told[1]["recipe_id"]


def test_another_camera_on_a_coarser_grid(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "coarse"
    command = [
        "sense",
        str(finished_dataset),
        "--out",
        str(out),
        "--jobs",
        "1",
        "--size",
        "32x32",
        "--seed",
        "5",
    ]
    assert main([*command, "--sensor.netd-mk", "200", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["side_px"] == 2 and told["made"] == 4 and told["pairs"] == 16
    assert told["verified"] is True and told["findings"] == []
    for fine, coarse in zip(samples(finished_dataset, *TRUTH), samples(out, "thermal", *TRUTH), strict=True):
        blocks = fine["radiance"].astype(np.float64).reshape(32, 2, 32, 2).mean(axis=(1, 3))
        np.testing.assert_allclose(coarse["radiance"], blocks, rtol=1e-6)
        np.testing.assert_allclose(coarse["K"][:2] * 2, fine["K"][:2])
        assert fine["key"] == coarse["key"] and fine["split"] == coarse["split"]
        assert coarse["thermal"].shape == (32, 32)
    next(out.rglob("*.tar")).unlink()
    assert main([*command, "--sensor.netd-mk", "200"]) == 0 and verify(out).ok, (
        "the same command makes what is gone"
    )
    assert main([*command, "--sensor.netd-mk", "100"]) == 2, "another camera needs another directory"
    assert "sensor.netd_mk" in capsys.readouterr().err


def test_what_was_not_rendered_is_refused(finished_dataset: Path, tmp_path: Path, capsys: Any) -> None:
    out = tmp_path / "no"
    for flags, reason in (
        (("--camera.preset", "boson640"), "needs a new render"),
        (("--size", "128x128"), "needs a new render"),
        (("--sensor.netd", "3"), "netd_mk"),
    ):
        assert main(["sense", str(finished_dataset), "--out", str(out), *flags]) == 2
        assert reason in capsys.readouterr().err and not out.exists()
    assert main(["sense", str(finished_dataset), "--out", str(finished_dataset)]) == 2
    assert main(["sense", str(finished_dataset)]) == 2
