"""ONNX graphs answer as the networks do, and fly where they can."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from scenegen.foundation.errors import InputError
from scenegen_cli.main import main
from scenegen_render.camera import Camera
from scenegen_trainers.deploy.budget import untrained
from scenegen_trainers.deploy.cost import cost_of, onnx_session
from scenegen_trainers.deploy.graph import onnx_graph, takes_counts
from scenegen_trainers.models.checkpoint import Checkpoint, read_checkpoint, write_checkpoint
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.pilots.onnx import OnnxDepth
from scenegen_trainers.training.recipe import MODELS

CAMERA = {"width_px": 48, "height_px": 32, "hfov_deg": 90.0}


def network(architecture: str, knobs: dict[str, object], **inputs: object) -> Checkpoint:
    torch.manual_seed(0)
    made = DepthNetwork(architecture, knobs, {"flow": "none", **inputs}, {})
    for module in made.modules():
        if isinstance(module, torch.nn.BatchNorm2d):  # as after some training
            module.running_mean.uniform_(-0.1, 0.1)
            module.running_var.uniform_(0.5, 1.5)
    return Checkpoint(made.eval(), CAMERA, {"model": architecture})


def frames(count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    relief = rng.normal(size=(count, 32, 48)).cumsum(axis=1).cumsum(axis=2)
    return np.rint(6000.0 + 40.0 * relief).astype(np.float32)


UNET = {"width": 4, "downs": 4}


@pytest.mark.parametrize(
    ("architecture", "knobs", "inputs"),
    [
        ("pix2pix", UNET, {}),
        ("pix2pix", UNET, {"gain": "minmax", "frames": 2}),
        ("pix2pix", UNET, {"gain_shared": False, "frames": 2}),
        ("fastdepth", {"width": 0.125}, {}),
        ("litemono", {"width": 0.25}, {}),
    ],
)
def test_from_counts_to_metres(
    architecture: str, knobs: dict[str, object], inputs: dict[str, object]
) -> None:
    made = network(architecture, knobs, **inputs)
    session = onnx_session(onnx_graph(made), 1)
    now, before = frames(3), frames(4)[1:] * 1.1
    answer = session.run(
        None, {i.name: {"counts": now, "previous": before}[i.name] for i in session.get_inputs()}
    )[0]
    with torch.inference_mode():
        wanted = made.network(torch.from_numpy(now), torch.from_numpy(before)).numpy()
    assert wanted.std() > 1e-3
    # A pixel on the edge between two grey levels may round the other way; nothing else may differ.
    assert np.abs(answer - wanted).mean() < 1e-3 * wanted.std() and np.abs(answer - wanted).max() < 0.2


def test_with_flow_the_graph_takes_the_embedded_image_and_is_no_pilot(tmp_path: Path) -> None:
    made = network("pix2pix", UNET, flow="farneback")
    assert not takes_counts(made.network.inputs)
    graph = onnx_graph(made)
    image = np.random.default_rng(0).integers(0, 256, (2, 1, 32, 48)).astype(np.uint8)
    answer = onnx_session(graph, 1).run(None, {"embedded": image})[0]
    with torch.inference_mode():
        wanted = made.network.metres(torch.from_numpy(image).float() * (2.0 / 255.0) - 1.0).numpy()
    assert answer == pytest.approx(wanted, abs=1e-3)
    path = tmp_path / "flow.onnx"
    path.write_bytes(graph)
    with pytest.raises(InputError, match="uint8"):
        OnnxDepth(path, Camera.from_fov(48, 32, 90.0))


def test_cost_counts_multiplications(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A 1x1 image through 7 halvings is padded to 128x128; here 4 halvings of 32x48, layer by layer by hand."""
    made = network("pix2pix", UNET)
    widths, macs, before, area = [4, 8, 16, 32], 0, 1, 32 * 48
    for width in widths:
        area //= 4
        macs += area * 16 * before * width
        before = width
    for after, incoming in ((16, 32), (8, 32), (4, 16), (1, 8)):
        macs += area * 16 * incoming * after  # a deconvolution multiplies once for each pixel that comes in
        area *= 4
    assert cost_of(made, onnx_graph(made), repeats=1).macs == macs
    config = {"architecture": "pix2pix", "knobs": UNET, "inputs": {"flow": "none"}, "target": {}}
    write_checkpoint(tmp_path / "model.pt", made.network.model, config, CAMERA, {"model": "pix2pix"})
    assert read_checkpoint(tmp_path / "model.pt").record == {"model": "pix2pix"}
    assert main(["onnx", str(tmp_path / "model.pt"), "--repeats", "1"]) == 0
    assert "pix2pix" in capsys.readouterr().out
    pilot = OnnxDepth(tmp_path / "model.onnx", Camera.from_fov(48, 32, 90.0))
    assert pilot.name == "model"


def test_a_graph_without_onnx_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(InputError, match=r"needs onnx: pip install 'thermal-scenegen\[onnx\]'$"):
        onnx_graph(network("pix2pix", UNET))


def test_a_budget_needs_no_training(capsys: pytest.CaptureFixture[str]) -> None:
    """Weights of the paper's generator, layer by layer: 4x4 kernels, two numbers a normalised channel."""
    widths = [64, 128, 256, 512, 512, 512, 512]
    down = 16 * sum(a * b for a, b in zip([1, *widths], widths, strict=False)) + widths[0] + widths[-1]
    up = 16 * (widths[6] * widths[5] + sum(2 * widths[k] * widths[k - 1] for k in range(5, 0, -1)))
    paint = 16 * 2 * widths[0] + 1
    normalised = 2 * sum(widths[1:6]) + 2 * sum(widths[k - 1] for k in range(6, 0, -1))
    made = untrained("pix2pix-flow", "paper", 128, 128)
    assert sum(p.numel() for p in made.network.model.parameters()) == down + up + paint + normalised

    assert main(["budget", "--profile", "ci", "--size", "64x32", "--repeats", "1", "--json"]) == 0
    entries = {entry["model"]: entry for entry in json.loads(capsys.readouterr().out)}
    assert list(entries) == list(MODELS)
    assert {name for name, entry in entries.items() if not entry["cost"]["from_counts"]} == {"pix2pix-flow"}
    for entry in entries.values():
        cost = entry["cost"]
        assert (entry["width_px"], entry["height_px"], cost["threads"]) == (64, 32, 1)
        outside_ms = 0.0 if cost["from_counts"] else cost["input_ms"]
        assert entry["blind_m"] == pytest.approx(22.2e-3 * (outside_ms + cost["onnx_ms"]))
        assert cost["difference_m"] < 0.2
    arguments = ["budget", "--profile", "ci", "--size", "32x32", "--repeats", "1", "--markdown"]
    assert main(arguments) == 0
    lines = capsys.readouterr().out.strip().splitlines()
    assert lines[0].startswith("| network | frame | weights |") and len(lines) == 2 + len(MODELS)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--profile", "smal"], "perhaps you meant 'small'"),
        (["--size", "8x8"], "--size 8x8: sides of 16"),
        (["--threads", "0"], "at least 1"),
        (["none.pt"], "none.pt: no such file"),
    ],
)
def test_a_budget_that_cannot_be_made_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["budget", *arguments]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert said in line
