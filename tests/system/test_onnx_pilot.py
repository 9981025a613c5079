"""From a checkpoint to an ONNX graph to flights: both fly alike, by the commands a user types."""

import csv
from pathlib import Path

import numpy as np
import pytest
import torch

from scenegen_cli.main import main
from scenegen_trainers.models.checkpoint import read_checkpoint, write_checkpoint
from scenegen_trainers.models.network import DepthNetwork

WIDTH, HEIGHT, FLIGHTS = 48, 32, 4
SMALL = [
    *("--map", "city", "--size", f"{WIDTH}x{HEIGHT}", "--city.extent-m", "400", "--mission.distance-m", "45"),
    *("--loop.decision-s", "0.4", "--exposure.directions", "32", "--exposure.sun-step-min", "120"),
]


def opinionated(path: Path) -> None:
    """A network that never learned anything, with weights large enough to see far and near in what is warm and cold."""
    torch.manual_seed(3)
    config = {
        "architecture": "pix2pix",
        "knobs": {"width": 4, "downs": 4},
        "inputs": {"flow": "none"},
        "target": {},
    }
    network = DepthNetwork(**config).model
    with torch.no_grad():
        for weights in network.parameters():
            weights.mul_(9.0 if weights.ndim > 1 else 1.0)
    camera = {"width_px": WIDTH, "height_px": HEIGHT, "hfov_deg": 90.0}
    write_checkpoint(path, network, config, camera, {"model": "pix2pix"})


def rows(root: Path, pilot: str) -> list[dict[str, str]]:
    table = csv.DictReader((root / "flights.csv").read_text("utf-8").splitlines())
    return [row for row in table if row["pilot"] == pilot]


def test_a_graph_flies_as_its_checkpoint_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, root = tmp_path / "net.pt", tmp_path / "c"
    opinionated(model)
    counts = torch.from_numpy(np.random.default_rng(0).normal(6000.0, 300.0, (1, HEIGHT, WIDTH)))
    with torch.inference_mode():
        depth = read_checkpoint(model).network(counts.float(), counts.float())
    assert depth.std() > 5.0  # it has something to say
    assert main(["onnx", str(model), "--repeats", "1"]) == 0
    graph = (tmp_path / "net.onnx").rename(tmp_path / "graph.onnx")
    capsys.readouterr()

    pilots = ["--pilot", str(graph), "--versus", str(model)]
    flown = ["--flights", str(FLIGHTS), "--out", str(root), "--jobs", "1"]
    assert main(["fly", *pilots, *flown, *SMALL]) == 0
    assert "pilot failed" in capsys.readouterr().out
    ours, theirs = rows(root, "graph"), rows(root, "net")
    assert len(ours) == len(theirs) == FLIGHTS
    for one, other in zip(ours, theirs, strict=True):
        assert (one["flight"], one["outcome"], one["hit"]) == (
            other["flight"],
            other["outcome"],
            other["hit"],
        )
        assert one["outcome"] != "pilot", one["reason"]
        # Sums in another order differ in their last digit, and a planner weighs them: centimetres, not metres.
        for place in ("end_x_m", "end_y_m", "end_z_m", "time_s"):
            assert float(one[place]) == pytest.approx(float(other[place]), abs=0.2)
