"""Depth networks: counts in, metres out, and one line for every file that is none."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
import torch
from onnx import TensorProto, helper

import campaign_pilots
from scenegen.foundation.errors import InputError
from scenegen_flythrough.loop.pilot import Observation
from scenegen_render.camera import Camera
from scenegen_trainers.pilots.checkpoint import TorchDepth, save
from scenegen_trainers.pilots.frames import NEAREST_M, depth
from scenegen_trainers.pilots.onnx import OnnxDepth

CAMERA = Camera.from_fov(16, 12, 90.0)


def seen(flights: int = 3, first: bool = False) -> Observation:
    rng = np.random.default_rng(4)
    counts = rng.integers(4000, 9000, (flights, 12, 16)).astype(np.uint16)
    n = np.zeros((flights, 3))
    return Observation(
        flight=np.arange(flights),
        time_s=0.0,
        position_m=n,
        velocity_mps=n,
        yaw_rad=n[:, 0],
        goal_m=n,
        ceiling_m=n[:, 0],
        camera=CAMERA,
        world_from_camera=np.tile(np.eye(4), (flights, 1, 1)),
        counts=counts,
        previous_counts=None if first else np.roll(counts, 1, axis=2),
    )


def test_a_checkpoint_flies_as_the_network_it_was_made_of(tmp_path: Path) -> None:
    network = campaign_pilots.Warm(far_m=40.0)
    path = tmp_path / "warm.pt"
    save(path, network, {"far_m": 40.0}, CAMERA)
    source, what = TorchDepth(path, CAMERA), seen()
    assert (source.name, source.needs) == ("warm", {"thermal"})
    answer = source.estimate(what)
    assert answer.dtype == np.float32
    now, before = (torch.from_numpy(c.astype(np.float32)) for c in (what.counts, what.previous_counts))
    assert np.array_equal(answer, np.maximum(network(now, before).detach().numpy(), np.float32(NEAREST_M)))


def test_the_first_frame_is_its_own_predecessor(tmp_path: Path) -> None:
    path = tmp_path / "warm.pt"
    save(path, campaign_pilots.Warm(), {})
    what = seen(first=True)
    counts = torch.from_numpy(what.counts.astype(np.float32))
    expected = campaign_pilots.Warm()(counts, counts).detach().numpy()
    assert np.array_equal(
        TorchDepth(path, CAMERA).estimate(what), np.maximum(expected, np.float32(NEAREST_M))
    )


GOOD = {
    "scenegen": "depth-1",
    "network": "campaign_pilots:Warm",
    "config": {},
    "state": {"gain": torch.tensor(0.01)},
}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"scenegen": "depth-9"}, "does not say 'depth-1'"),
        ({"state": None}, "its key 'state'"),
        ({"network": "os:system", "config": {"command": "false"}}, "is not a torch.nn.Module"),
        ({"network": "campaign_pilots:NotANetwork"}, "is not a torch.nn.Module"),
        ({"network": "no.such:Thing"}, "cannot be imported"),
        ({"config": {"width": 3}}, "weights do not fit"),
        ({"state": {"gain": torch.zeros(3)}}, "weights do not fit"),
        ({"camera": {"width_px": 32, "height_px": 12}}, "add --size 32x12"),
        ({"camera": {"hfov_deg": 60.0}}, "add --camera.hfov-deg 60"),
    ],
)
def test_a_checkpoint_that_is_none_is_one_line(change: dict[str, Any], said: str, tmp_path: Path) -> None:
    path = tmp_path / "x.pt"
    torch.save({**GOOD, **change}, path)
    with pytest.raises(InputError) as caught:
        TorchDepth(path, CAMERA)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


class Evil:
    def __reduce__(self) -> tuple[Any, ...]:
        return (Path.touch, (Path("ran.txt"),))


def test_opening_a_checkpoint_runs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    torch.save({**GOOD, "config": {"x": Evil()}}, "evil.pt")
    with pytest.raises(InputError, match="no torch file of weights"):
        TorchDepth(Path("evil.pt"), CAMERA)
    assert not Path("ran.txt").exists()


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04broken", b"hello"])
def test_a_file_of_something_else_is_one_line(content: bytes, tmp_path: Path) -> None:
    for name, kind in (("x.pt", TorchDepth), ("x.onnx", OnnxDepth)):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=name):
            kind(tmp_path / name, CAMERA)


def graph(path: Path, shape: list[Any], inputs: int = 2, out: list[Any] | None = None) -> Path:
    """A graph that answers 0.01 counts - 0.005 previous counts."""
    names = ["counts", "previous"][:inputs]
    given = [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name in names]
    result = helper.make_tensor_value_info("depth", TensorProto.FLOAT, out or shape)
    scale = [
        helper.make_tensor("a", TensorProto.FLOAT, [], [0.01]),
        helper.make_tensor("b", TensorProto.FLOAT, [], [0.005]),
    ]
    nodes = [helper.make_node("Mul", ["counts", "a"], ["depth" if inputs == 1 else "x"])]
    if inputs == 2:
        nodes += [
            helper.make_node("Mul", ["previous", "b"], ["y"]),
            helper.make_node("Sub", ["x", "y"], ["depth"]),
        ]
    made = helper.make_graph(nodes, "g", given, [result], initializer=scale)
    model = helper.make_model(made, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.save(model, str(path))
    return path


@pytest.mark.parametrize("shape", [["n", 12, 16], ["n", 1, 12, 16], [1, 1, "r", "c"], [None, 12, 16]])
@pytest.mark.parametrize("inputs", [1, 2])
def test_an_onnx_graph_flies_whatever_its_batch(shape: list[Any], inputs: int, tmp_path: Path) -> None:
    what = seen()
    answer = OnnxDepth(graph(tmp_path / "g.onnx", shape, inputs), CAMERA).estimate(what)
    expected = 0.01 * what.counts.astype(float) - (0.005 * what.previous_counts.astype(float)) * (inputs == 2)
    assert answer.shape == (3, 12, 16)
    assert answer == pytest.approx(np.maximum(expected, NEAREST_M), rel=1e-5)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        (["n", 3, 12, 16], "a frame is"),
        (["n", 16], "a frame is"),
        (["n", 24, 32], "add --size 32x24"),
    ],
)
def test_a_graph_for_other_frames_is_one_line(shape: list[Any], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        OnnxDepth(graph(tmp_path / "g.onnx", shape, 1), CAMERA)


def test_missing_libraries_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def absent(name: str) -> Any:
        raise ImportError(name)

    for kind, module, extra in (
        (TorchDepth, "scenegen_trainers.models.torch_file", "torch"),
        (OnnxDepth, "scenegen_trainers.pilots.onnx", "onnx"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(f"{module}.importlib.import_module", absent)
            with pytest.raises(InputError, match=rf"thermal-scenegen\[{extra}\]"):
                kind(tmp_path / "x", CAMERA)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda like: like[:, 1:], "shape"),
        (lambda like: like[None], "shape"),
        (lambda like: np.where(like > 0, np.nan, like), "not a number"),
    ],
)
def test_answers_that_are_no_depth_are_refused(make: Callable[[np.ndarray], np.ndarray], said: str) -> None:
    like = np.ones((2, 12, 16), np.float32)
    with pytest.raises(ValueError, match=said):
        depth(make(like), like)


def test_sky_is_an_answer_and_nothing_is_nearer_than_nothing() -> None:
    like = np.ones((1, 2, 2), np.float32)
    answer = depth(np.array([[[np.inf, -3.0], [0.0, 7.0]]]), like)
    assert answer.tolist() == [[[np.inf, pytest.approx(NEAREST_M)], [pytest.approx(NEAREST_M), 7.0]]]
