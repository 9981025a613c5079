"""Documents that somebody wrote anew, seals and sums included, contradict each other, and that is named."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.canonical import pretty
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.finish import finish
from scenegen_datasets.index import ROW
from scenegen_datasets.manifest import manifest_bytes, read_manifest
from scenegen_datasets.seal import sealed, unsealed, with_seal

Found = Callable[..., dict[str, str]]


def forge(dataset: Path, job: object, change: Callable[[dict[str, object]], None]) -> None:
    """Rewrite a receipt, seal included, as somebody would who knows the format."""
    path = dataset / job.receipt  # type: ignore[attr-defined]
    body = unsealed("receipt", path.read_bytes(), "x")
    change(body)
    path.write_bytes(sealed("receipt", body))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda b: b["frames"][1].update(time_s=-1.0), "times do not rise"),
        (lambda b: b["frames"][1]["world_from_camera"][0].__setitem__(0, 2.0), "not a rotation"),
        (lambda b: b["frames"][1]["K"][0].__setitem__(0, 15.0), "K differs"),
        (lambda b: b["frames"][1]["digests"].update(depth="0" * 64), "decoded depth differs"),
        (lambda b: b["frames"][1]["statistics"].update(counts_min=1), "statistics in the receipt differ"),
        (lambda b: b["frames"][1]["members"].pop("flow.exr"), "other members"),
        (lambda b: b["frames"].pop(), "holds 3 frames"),
        (lambda b: b["frames"][1]["members"]["depth.tiff"].__setitem__(0, 10**12), "outside the shard"),
        (lambda b: b["frames"][1]["members"]["depth.tiff"].__setitem__(1, 2**40), "outside the shard"),
        (lambda b: b["frames"][1]["members"]["depth.tiff"].__setitem__(1, -5), "outside the shard"),
        (lambda b: b["frames"][1]["members"]["depth.tiff"].__setitem__(1, True), "not whole numbers"),
        (lambda b: b["clip"].update(width_px=60_000, height_px=60_000), "outside the shard"),
        (lambda b: b["clip"].update(width_px=100_000, height_px=100_000), "clip.width_px is not"),
        (lambda b: b["clip"]["job"].update(map="../../etc"), "not a receipt"),
        (lambda b: b["clip"]["job"].update(world=3), "speaks of"),
        (lambda b: b["clip"]["job"].update(pairs=10**9), "not a receipt"),
        (lambda b: b.update(schema_version=2), "update scenegen"),
        (lambda b: b.update(frames={"a": 1}), "not a receipt"),
        (lambda b: b.pop("clip"), "not a receipt"),
        (lambda b: b.update(fingerprint="0" * 16), "made by software (0000000000000000)"),
        (lambda b: b.update(layers=["thermal", "x-ray"]), "unknown layers"),
    ],
)
def test_forged_receipts_are_found(
    dataset: Path, found: Found, fakes: ModuleType, change: Callable[[dict[str, object]], None], reason: str
) -> None:
    job = fakes.jobs(1)[0]
    forge(dataset, job, change)
    names = found(dataset)
    mine = {file: why for file, why in names.items() if file == job.receipt or file.startswith(job.shard)}
    assert reason in "".join(mine.values()), mine


def reseal(dataset: Path) -> None:
    """Bring manifest and description in line with a forged tree, so that only the forgery itself remains."""
    sums = {
        p: hashlib.sha256((dataset / p).read_bytes()).hexdigest()
        for p in read_manifest(dataset / "MANIFEST.sha256")
    }
    (dataset / "MANIFEST.sha256").write_bytes(manifest_bytes(sums))


def test_a_forged_index_is_found(dataset: Path, found: Found) -> None:
    data = bytearray((dataset / "index.npy").read_bytes())
    rows = np.frombuffer(data, ROW, offset=len(data) - 24 * ROW.itemsize)
    rows["time_s"][5] = 99.0
    (dataset / "index.npy").write_bytes(data)
    reseal(dataset)
    assert "row 5 (city-00000-001-0001) differs from receipts" in found(dataset)["index.npy"]


def test_a_forged_description_is_found(dataset: Path, found: Found) -> None:
    body = json.loads((dataset / "dataset.json").read_bytes())
    body.pop("seal")
    body["counts"]["pairs"] += 1
    (dataset / "dataset.json").write_bytes(pretty(with_seal(body)))
    reseal(dataset)
    assert "counts" in found(dataset)["dataset.json"]
    body["schema_version"] = 99
    (dataset / "dataset.json").write_bytes(pretty(with_seal(body)))
    assert "update scenegen" in found(dataset)["dataset.json"]


def test_a_world_in_two_splits_is_found(fakes: ModuleType, tmp_path: Path, found: Found) -> None:
    root = fakes.make(tmp_path / "d", 1, done=False)
    job = replace(fakes.jobs(2)[1], split="test")
    commit_clip(root, fakes.record(job), fakes.encoded(job), fingerprint=fakes.FINGERPRINT)
    finish(root, [*fakes.jobs(1), job])
    assert "in two splits" in "".join(found(root).values())


def test_two_clips_in_one_place_of_the_plan_are_found(dataset: Path, found: Found, fakes: ModuleType) -> None:
    forge(dataset, fakes.jobs(6)[5], lambda b: b["clip"]["job"].update(ordinal=4))  # type: ignore[index]
    assert "has the place in the plan of" in found(dataset)[fakes.jobs(6)[5].receipt]


def test_a_lock_that_contradicts_itself_is_found(dataset: Path, found: Found) -> None:
    lock = json.loads((dataset / "recipe.lock.json").read_bytes())
    lock["recipe"]["map"] = "field"
    (dataset / "recipe.lock.json").write_bytes(pretty(lock))
    reseal(dataset)
    assert "recipe_id is not that" in found(dataset)["recipe.lock.json"]
