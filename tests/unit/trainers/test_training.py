"""Trainings that are killed, resumed, repeated, and refused."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.resolve import Source
from scenegen_render.camera import Camera
from scenegen_trainers.models.checkpoint import read_checkpoint
from scenegen_trainers.models.torch_file import unpacked, write_packed
from scenegen_trainers.pilots.checkpoint import TorchDepth
from scenegen_trainers.training.loop import MODEL, Taught, train
from scenegen_trainers.training.machine import Machine
from scenegen_trainers.training.recipe import TrainingKnobs, TrainingRecipe, resolve_training
from scenegen_trainers.training.samples import Draw, batches
from scenegen_trainers.training.source import TrainingData

TINY: dict[str, Any] = {
    "pix2pix": {"width": 4, "judge_width": 4, "downs": 4},
    "fastdepth": {"width": 0.125},
    "litemono": {"width": 0.25},
    "training": {"steps": 6, "keep": 2, "judge": 3, "judge_pairs": 4, "log": 1},
}


def recipe(model: str = "pix2pix-flow", **more: Any) -> TrainingRecipe:
    return resolve_training(model, "ci", [Source("", TINY), Source("", more)])


def taught(data: Path, out: Path, model: str = "pix2pix-flow", **more: Any) -> Path:
    return train(recipe(model, **more), TrainingData.at(data), out, Machine())


def log_of(out: Path) -> list[dict[str, str]]:
    with (out / "log.csv").open(newline="") as file:
        return list(csv.DictReader(file))


class KilledError(Exception):
    pass


REDRAWN = {"inputs": {"frames": 2, "flow": "truth"}, "training": {"noise": "redrawn"}}


@pytest.mark.parametrize(("model", "more"), [("pix2pix-flow", {}), ("pix2pix", REDRAWN), ("litemono", {})])
def test_a_killed_training_ends_where_an_undisturbed_one_does(
    toy: Path, tmp_path: Path, model: str, more: dict[str, Any]
) -> None:
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    taught(toy, whole, model, **more)

    def kill(now: Taught) -> None:
        if now.step == 5:  # one step past the last saved state
            raise KilledError

    with pytest.raises(KilledError):
        train(recipe(model, **more), TrainingData.at(toy), broken, Machine(), kill)
    assert not (broken / MODEL).exists()
    steps: list[int] = []
    train(recipe(model, **more), TrainingData.at(toy), broken, Machine(), lambda now: steps.append(now.step))
    assert steps == [5, 6]
    assert (whole / MODEL).read_bytes() == (broken / MODEL).read_bytes()
    assert (whole / "log.csv").read_bytes() == (broken / "log.csv").read_bytes()
    assert sorted(p.name for p in (whole / "samples").iterdir()) == ["00000003.png", "00000006.png"]


def test_a_finished_training_is_left_alone(toy: Path, tmp_path: Path) -> None:
    path = taught(toy, tmp_path / "a")
    before = path.stat().st_mtime_ns
    assert taught(toy, tmp_path / "a") == path
    assert path.stat().st_mtime_ns == before


def test_a_network_that_was_removed_is_made_anew(toy: Path, tmp_path: Path) -> None:
    path = taught(toy, tmp_path / "a")
    before = path.read_bytes(), (tmp_path / "a" / "log.csv").read_bytes()
    path.unlink()
    taught(toy, tmp_path / "a")
    assert (path.read_bytes(), (tmp_path / "a" / "log.csv").read_bytes()) == before


def test_another_training_is_not_overwritten(toy: Path, tmp_path: Path) -> None:
    taught(toy, tmp_path / "a")
    with pytest.raises(InputError, match=r"another pix2pix\.w_l1 \(100\.0, now 300\.0\)"):
        taught(toy, tmp_path / "a", pix2pix={"w_l1": 300.0})
    with pytest.raises(InputError, match="another seed"):
        taught(toy, tmp_path / "a", seed=1)
    with pytest.raises(InputError, match=r"another model \(pix2pix-flow, now fastdepth\)"):
        taught(toy, tmp_path / "a", "fastdepth")


def test_two_trainings_do_not_share_a_directory(toy: Path, tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    with DirectoryLock(tmp_path / "a"), pytest.raises(InputError, match="is being written by process"):
        taught(toy, tmp_path / "a")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file; name a directory"):
        taught(toy, tmp_path / "file")


def test_the_seed_decides(toy: Path, tmp_path: Path) -> None:
    a, b = (unpacked(taught(toy, tmp_path / str(k), seed=k))["state"] for k in (0, 1))
    assert not all(torch.equal(a[name], b[name]) for name in a)


@pytest.mark.parametrize(
    ("model", "loss"),
    [("pix2pix", "l1"), ("pix2pix-flow", "l1"), ("fastdepth", "silog"), ("litemono", "silog")],
)
def test_losses_fall_and_depth_is_learned(toy: Path, tmp_path: Path, model: str, loss: str) -> None:
    knobs = {"steps": 60, "judge": 60, "learning_rate": 2e-3, "log": 5}
    taught(toy, tmp_path / "a", model, training=knobs)
    rows = log_of(tmp_path / "a")
    first, last = (np.mean([float(row[loss]) for row in some]) for some in (rows[:2], rows[-2:]))
    assert last < 0.7 * first
    assert float(rows[-1]["val_rel"]) < 1.0


def test_true_flow_two_frames_and_redrawn_noise(toy: Path, tmp_path: Path) -> None:
    inputs = {"flow": "truth", "frames": 2}
    path = taught(toy, tmp_path / "a", inputs=inputs, training={"noise": "redrawn"})
    network = read_checkpoint(path).network
    assert network.inputs.channels == 2
    frame = torch.full((1, 32, 32), 5000.0)
    with pytest.raises(InputError, match="known in datasets only"):
        network(frame, frame)
    flow = np.zeros((1, 32, 32, 2), np.float32)
    assert network(frame, frame, flow).shape == (1, 32, 32)


def test_noise_is_redrawn_from_epoch_to_epoch(toy: Path) -> None:
    data, asked = TrainingData.at(toy), recipe("pix2pix", training={"noise": "redrawn"})
    samples = data.samples("train", asked)
    first, again, later = (samples[Draw(2, epoch=k)].image for k in (0, 0, 1))
    assert (first == again).all() and (first != later).any()
    stored = data.samples("train", asked, stored=True)
    assert stored[Draw(2)].image.shape == first.shape


def test_mirroring_before_or_after_embedding(toy: Path) -> None:
    """Afterwards it moves the grid, since 31 is no multiple of 5; what is painted as truth is the same."""
    data = TrainingData.at(toy)
    before, after = (data.samples("train", recipe(training={"mirror": how})) for how in (True, "embedded"))
    plain, straight, mirrored = before[Draw(1)], after[Draw(1)], after[Draw(1, mirror=True)]
    assert (plain.image == straight.image).all()
    assert (mirrored.image == plain.image[..., ::-1]).all()
    other = before[Draw(1, mirror=True)]
    assert (other.image != mirrored.image).any() and (other.depth_m == mirrored.depth_m).all()


def test_every_epoch_shows_each_sample_once() -> None:
    knobs = TrainingKnobs(steps=20, batch=3)
    draws = [d for batch in batches(10, knobs, 7, 0) for d in batch]
    for epoch in range(6):
        assert sorted(d.index for d in draws if d.epoch == epoch) == list(range(10))
    assert draws[:10] != draws[10:20]
    assert 15 < sum(d.mirror for d in draws) < 45
    assert draws[9:] == [d for batch in batches(10, knobs, 7, 3) for d in batch]
    halves = [list(batches(10, TrainingKnobs(steps=5, batch=4), 7, 0, slice(r, None, 2))) for r in (0, 1)]
    both = [{d.index for d in (*a, *b)} for a, b in zip(*halves, strict=True)]
    assert both == [{d.index for d in b} for b in batches(10, TrainingKnobs(steps=5, batch=4), 7, 0)]


def test_a_checkpoint_flies_and_answers_as_it_is_judged(toy: Path, tmp_path: Path) -> None:
    path = taught(toy, tmp_path / "a")
    data, checkpoint = TrainingData.at(toy), read_checkpoint(path)
    samples = data.samples("test", recipe())
    raw = samples.raw(1)
    counts, previous = (
        torch.from_numpy(raw[k].astype(np.float32))[None] for k in ("thermal", "previous_thermal")
    )
    with torch.inference_mode():
        direct = checkpoint.network(counts, previous)[0].numpy()
    camera = Camera(32, 32, 14.0, (16.0, 16.0))
    pilot = TorchDepth(path, camera)
    with torch.inference_mode():
        flown = pilot._network(counts, previous)[0].numpy()
    assert (direct == flown).all()
    from scenegen_trainers.evaluation.answers import answers

    judged = list(answers(checkpoint.network.metres, samples))[1].estimate_m
    assert np.abs(judged - direct).max() < 1e-3
    with pytest.raises(InputError, match="32x32"):
        TorchDepth(path, Camera(64, 32, 14.0, (32.0, 16.0)))


def test_equal_content_is_equal_bytes_wherever_its_words_came_from(tmp_path: Path) -> None:
    def content(word: str, again: str) -> dict[str, Any]:
        return {word: [again, {"deep": (again, 1)}], "weights": torch.ones(2)}

    apart = "".join(["pix", "2pix"])
    write_packed(tmp_path / "a.pt", content("pix2pix", "pix2pix"))
    write_packed(tmp_path / "b.pt", content("pix2pix", apart))
    assert (tmp_path / "a.pt").read_bytes() == (tmp_path / "b.pt").read_bytes()
    assert unpacked(tmp_path / "a.pt")["pix2pix"] == ["pix2pix", {"deep": ("pix2pix", 1)}]


def test_what_is_no_checkpoint_is_refused_in_one_line(toy: Path, tmp_path: Path) -> None:
    path = taught(toy, tmp_path / "a")
    with pytest.raises(InputError, match="no such file"):
        read_checkpoint(tmp_path / "none.pt")
    with pytest.raises(InputError, match=r"is a directory; .* model\.pt"):
        read_checkpoint(tmp_path / "a")
    noise = tmp_path / "noise.pt"
    noise.write_bytes(b"\x80\x04 nonsense")
    with pytest.raises(InputError, match="no torch file of weights"):
        read_checkpoint(noise)
    code = tmp_path / "code.pt"
    torch.save({"scenegen": "depth-1", "network": Path("x")}, code)
    with pytest.raises(InputError, match="no torch file of weights"):
        read_checkpoint(code)
    with pytest.raises(InputError, match="no depth network"):
        read_checkpoint(tmp_path / "a" / "state.pt")
    content = unpacked(path)
    content["config"]["knobs"]["width"] = 8
    torch.save(content, tmp_path / "other.pt")
    with pytest.raises(InputError, match="do not fit"):
        read_checkpoint(tmp_path / "other.pt")
    torch.save({**content, "record": None}, tmp_path / "other.pt")
    with pytest.raises(InputError, match="its key 'record' is missing"):
        read_checkpoint(tmp_path / "other.pt")
    torch.save({**content, "camera": {"width_px": 32, "height_px": 32}}, tmp_path / "other.pt")
    with pytest.raises(InputError, match="does not say the 'hfov_deg' of the frames"):
        read_checkpoint(tmp_path / "other.pt")
    torch.save({**content, "network": "torch.nn:Identity"}, tmp_path / "other.pt")
    with pytest.raises(InputError, match=r"holds 'torch\.nn:Identity', no network of `scenegen train`"):
        read_checkpoint(tmp_path / "other.pt")
    content["config"]["architecture"] = "resnet"
    torch.save(content, tmp_path / "other.pt")
    with pytest.raises(InputError, match="unknown network 'resnet'"):
        read_checkpoint(tmp_path / "other.pt")
