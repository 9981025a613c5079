"""Other frameworks get the very arrays: PyTorch, Lightning, WebDataset, Hugging Face, and plain len and []."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets import PairDataset
from scenegen_datasets.adapters.webdataset import decoder, unpacked
from scenegen_datasets.index import job_of
from scenegen_datasets.layers import DEFAULT_LAYERS

torch = pytest.importorskip("torch")


def depth_only(sample: dict[str, Any]) -> dict[str, Any]:
    return {"key": sample["key"], "depth": np.minimum(sample["depth"], 100.0)}


def keys(loader: Any, batches: int | None = None) -> list[str]:
    found: list[str] = []
    for k, batch in enumerate(loader):
        found += batch["key"]
        if batches is not None and k + 1 == batches:
            break
    return found


def test_tensors_are_the_arrays(fakes: ModuleType, tmp_path: Path) -> None:
    from scenegen_datasets.adapters.torch import PairLoader

    layers = ("thermal", "depth", "flow", "instance", "material", "covisible", "imu")
    pairs = PairDataset(fakes.make(tmp_path / "d", 2, layers=layers), layers=layers)
    (batch,) = PairLoader(pairs, 6, shuffle=False)
    assert batch["key"] == [s["key"] for s in pairs]
    kinds = {
        "thermal": "uint16",
        "depth": "float32",
        "instance": "uint32",
        "covisible": "bool",
        "K": "float64",
    }
    assert {name: str(batch[name].dtype).removeprefix("torch.") for name in kinds} == kinds
    for k, sample in enumerate(pairs):
        for name in layers[:-1]:
            np.testing.assert_array_equal(batch[name][k].numpy(), sample[name])
        np.testing.assert_array_equal(batch["imu"][k].numpy(), sample["imu"])
        assert batch["facts"]["hour"][k].item() == sample["facts"]["hour"]
    assert batch["frame"].dtype == torch.int64 and batch["split"] == ["train"] * 6


def test_a_loader_with_workers_continues_where_its_user_was(pristine: Path) -> None:
    from scenegen_datasets.adapters.torch import PairLoader

    def loader(workers: int) -> PairLoader:
        return PairLoader(PairDataset(pristine), 4, workers=workers, transform=depth_only, seed=3)

    straight = loader(0)
    whole = [keys(straight) for _ in range(3)]
    assert len(straight) == 5 and all(len(set(one)) == 18 for one in whole) and whole[0] != whole[1]
    apart = loader(2)
    assert keys(apart) == whole[0]
    assert keys(apart, 2) == whole[1][:8], "two batches taken, more of them read ahead"
    state = json.loads(json.dumps(apart.state_dict()))
    assert keys(apart) == whole[1][8:]
    resumed = loader(0)
    resumed.load_state_dict(state)
    assert keys(resumed) == whole[1][8:] and keys(resumed) == whole[2]


@pytest.mark.parametrize("drop_last", [False, True])
def test_the_order_and_the_position_know_nothing_of_workers(pristine: Path, drop_last: bool) -> None:
    """Stop behind every batch with one number of workers, go on with another."""
    from scenegen_datasets.adapters.torch import PairLoader

    def loader(workers: int) -> PairLoader:
        pairs = PairDataset(pristine, layers=())
        return PairLoader(pairs, 5, workers=workers, seed=8, spawn=False, drop_last=drop_last)

    straight = loader(0)
    whole = [keys(straight) for _ in range(2)]
    for stop, (before, after) in enumerate(((0, 2), (2, 0), (1, 2)), 1):
        first = loader(before)
        assert keys(first, stop) == whole[0][: 5 * stop]
        second = loader(after)
        second.load_state_dict(json.loads(json.dumps(first.state_dict())))
        assert keys(second) == (whole[0][5 * stop :] or whole[1])
        assert keys(second)[:5] == (whole[1] if 5 * stop < len(whole[0]) else keys(straight))[:5]


def test_ranks_and_full_batches(pristine: Path) -> None:
    from scenegen_datasets.adapters.torch import PairLoader

    pairs = PairDataset(pristine)
    found = [keys(PairLoader(pairs, 4, rank=r, ranks=2, clips_at_once=2, drop_last=True)) for r in (0, 1)]
    assert [len(one) for one in found] == [8, 8] and not set(found[0]) & set(found[1])


def test_a_pass_without_a_batch_is_over_and_the_next_one_comes(pristine: Path) -> None:
    from scenegen_datasets.adapters.torch import PairLoader

    loader = PairLoader(PairDataset(pristine, "val", ()), 7, drop_last=True)
    assert (keys(loader), keys(loader), loader.epoch.epoch) == ([], [], 2)


class Kept:
    """Batches a training step saw."""

    def __init__(self) -> None:
        self.keys: list[str] = []


def lightning_parts(kept: Kept, stop_at: int | None) -> Any:
    import lightning

    class Learner(lightning.LightningModule):
        def __init__(self) -> None:
            super().__init__()
            self.weight = torch.nn.Parameter(torch.zeros(()))

        def training_step(self, batch: dict[str, Any], index: int) -> Any:
            kept.keys += batch["key"]
            return ((self.weight - batch["depth"].clamp(max=100).mean()) ** 2).mean()

        def configure_optimizers(self) -> Any:
            return torch.optim.SGD(self.parameters(), 1e-6)

    return Learner(), {"max_epochs": 2, "max_steps": stop_at or -1}


def fitted(
    root: Path, folder: Path, stop_at: int | None = None, resume: Path | None = None
) -> tuple[Kept, Path]:
    import lightning
    from lightning.pytorch.callbacks import ModelCheckpoint

    from scenegen_datasets.adapters.lightning import PairModule

    kept = Kept()
    learner, limits = lightning_parts(kept, stop_at)
    trainer = lightning.Trainer(
        accelerator="cpu",
        logger=False,
        callbacks=[ModelCheckpoint(folder, "{step}", save_top_k=-1, every_n_train_steps=1)],
        enable_progress_bar=False,
        enable_model_summary=False,
        default_root_dir=folder,
        **limits,
    )
    trainer.fit(learner, datamodule=PairModule(root, 2, seed=4), ckpt_path=resume, weights_only=False)
    return kept, folder / "step=2.ckpt"


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")
def test_a_lightning_fit_goes_on_with_the_next_batch(pristine: Path, tmp_path: Path) -> None:
    pytest.importorskip("lightning")
    whole, on_the_way = fitted(pristine, tmp_path / "whole")
    assert len(whole.keys) == 12 and len(set(whole.keys[:6])) == 6
    part, stopped = fitted(pristine, tmp_path / "part", stop_at=2)
    assert part.keys == whole.keys[:4]
    for k, saved in enumerate((on_the_way, stopped)):
        assert fitted(pristine, tmp_path / f"rest{k}", resume=saved)[0].keys == whole.keys[4:]


def shards(root: Path) -> list[str]:
    return sorted(map(str, (root / "shards/train").rglob("*.tar")))


@pytest.mark.filterwarnings("ignore")
def test_webdataset_decodes_every_member_exactly(pristine: Path) -> None:
    webdataset = pytest.importorskip("webdataset")
    stream = webdataset.WebDataset(shards(pristine), shardshuffle=False, nodesplitter=None)
    pairs = PairDataset(pristine, "train", layers=DEFAULT_LAYERS)
    found = {s["key"]: s for s in stream.decode(decoder).map(unpacked)}
    assert len(found) == 8, "all frames, those without a predecessor too"
    for sample in pairs:
        mine = found[sample["key"]]
        for name in DEFAULT_LAYERS:
            assert mine[name].dtype == sample[name].dtype
            np.testing.assert_array_equal(mine[name], sample[name])
        np.testing.assert_array_equal(mine["world_from_camera"], sample["world_from_camera"])


@pytest.mark.filterwarnings("ignore")
def test_webdataset_deals_shards_to_nodes_and_workers_once(
    pristine: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    webdataset = pytest.importorskip("webdataset")
    urls = sorted(map(str, pristine.rglob("*.tar")))

    def seen(node: int, worker: int) -> list[str]:
        place = {"RANK": node, "WORLD_SIZE": 2, "WORKER": worker, "NUM_WORKERS": 3}
        for name, value in place.items():
            monkeypatch.setenv(name, str(value))
        stream = webdataset.WebDataset(urls, shardshuffle=9, seed=1, nodesplitter=webdataset.split_by_node)
        return [sample["__key__"] for sample in stream]

    found = [key for node in range(2) for worker in range(3) for key in seen(node, worker)]
    frames = PairDataset(pristine)._source.rows
    assert len(found) == len(set(found)) == len(frames) == 24


def test_the_decoder_leaves_strangers_alone_and_refuses_damage(pristine: Path) -> None:
    pairs = PairDataset(pristine, layers=DEFAULT_LAYERS)
    row = pairs._source.rows[1]
    job = job_of(row)
    assert decoder(".jpg", b"x") is None and decoder("__key__", b"x") is None
    for member in ("thermal.png", "depth.tiff", "flow.exr", "truth.exr"):
        data = pairs._reader.stored(row, job, member)
        assert decoder(f".{member}", data)
        for bad in (data[: len(data) // 2], b"", data[:20], b"\xff" * 100):
            with pytest.raises(CorruptFrameError):
                decoder(f".{member}", bad)


@pytest.mark.filterwarnings("ignore")
def test_hugging_face_reads_the_shards_as_they_are(pristine: Path, tmp_path: Path, monkeypatch: Any) -> None:
    pytest.importorskip("datasets.arrow_dataset")
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    import datasets

    files = {"train": str(pristine / "shards/train/*/*.tar")}
    for streaming in (True, False):
        found = datasets.load_dataset(
            "webdataset", data_files=files, split="train", streaming=streaming, cache_dir=str(tmp_path)
        )
        by_key = {row["__key__"]: row for row in found}
        for sample in PairDataset(pristine, "train"):
            row = by_key[sample["key"]]
            np.testing.assert_array_equal(np.asarray(row["thermal.png"]), sample["thermal"])
            np.testing.assert_array_equal(np.asarray(row["depth.tiff"]), sample["depth"])
            np.testing.assert_array_equal(row["json"]["K"], sample["K"])


def test_len_and_brackets_are_all_there_is_to_a_random_access_source(pristine: Path) -> None:
    """What Grain's `RandomAccessDataSource` and TensorFlow's `from_generator` ask for, from several threads at once."""
    from concurrent.futures import ThreadPoolExecutor

    from scenegen_datasets.epoch import Epoch

    pairs = PairDataset(pristine)
    order = list(Epoch(pairs, 7)) * 6
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(pairs.__getitem__, order))
    for index, sample in zip(order, found, strict=True):
        np.testing.assert_array_equal(sample["depth"], pairs[index]["depth"])
