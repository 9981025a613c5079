"""What a directory may hold before something is written into it, and what is refused with which words."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from scenegen.foundation.canonical import canonical
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.content import clip_digest, content_id
from scenegen_datasets.finish import finish
from scenegen_datasets.info import info
from scenegen_datasets.lock import fingerprint_id, recipe_id
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.store import create_or_open, finished, read_lock


def test_another_recipe_is_refused_with_keys_and_values(fakes: ModuleType, dataset: Path) -> None:
    before = fakes.tree(dataset)
    with pytest.raises(InputError, match=r"camera.netd_mk: 50.0 -> 35.0"):
        create_or_open(dataset, "x", fakes.lock(18, camera={"netd_mk": 35.0}))
    with pytest.raises(InputError, match=r"camera.lag: null -> 1.5"):
        create_or_open(dataset, "x", fakes.lock(18, camera={"lag": 1.5}))
    assert fakes.tree(dataset) == before


def test_fewer_pairs_are_refused(fakes: ModuleType, dataset: Path) -> None:
    with pytest.raises(InputError, match="--pairs 18 or more"):
        create_or_open(dataset, "x", fakes.lock(9))


def test_another_meaning_of_the_same_recipe_is_refused(fakes: ModuleType, dataset: Path) -> None:
    lock = fakes.lock(18)
    lock |= {"scene_semantics": 2, "recipe_id": recipe_id(lock["recipe"], 2)}
    with pytest.raises(InputError, match="1 -> 2"):
        create_or_open(dataset, "x", lock)


def test_another_renderer_is_refused_unless_mixing_is_allowed(fakes: ModuleType, dataset: Path) -> None:
    other = fakes.lock(18, render={"mitsuba": "3.9.2", "variant": "llvm_ad_mono"})
    with pytest.raises(InputError, match=r"mitsuba: \"3.9.1\" -> \"3.9.2\".*--allow-mixed"):
        create_or_open(dataset, "x", other)
    create_or_open(dataset, "x", other, allow_mixed=True)
    lock = read_lock(dataset)
    assert lock["fingerprint"]["mitsuba"] == "3.9.1"
    assert [p["mitsuba"] for p in lock["mixed_with"]] == ["3.9.2"]
    create_or_open(dataset, "x", other)
    assert read_lock(dataset) == lock


def test_resuming_with_the_same_recipe_touches_nothing(fakes: ModuleType, dataset: Path) -> None:
    before = fakes.tree(dataset)
    lock = fakes.lock(18)
    lock["recipe"]["jobs"] = 7
    create_or_open(dataset, "pairs: 18\njobs: 7\n", lock)
    assert fakes.tree(dataset) == before


def test_growth_takes_the_old_proof_away_first(fakes: ModuleType, dataset: Path) -> None:
    create_or_open(dataset, "pairs: 24\n", fakes.lock(24))
    assert not (dataset / "dataset.json").exists()
    assert not (dataset / "MANIFEST.sha256").exists()
    assert info(dataset).pairs_planned == 24
    assert not info(dataset).complete
    assert info(dataset).pairs == 18


def test_a_directory_that_is_no_dataset_is_left_alone(fakes: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(InputError, match=r"thesis\.tex"):
        create_or_open(tmp_path, "x", fakes.lock(3))
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]
    with pytest.raises(InputError, match="not a directory"):
        create_or_open(tmp_path / "thesis.tex", "x", fakes.lock(3))


@pytest.mark.parametrize("name", ["dataset.json", "index.npy", "shards", "recipe.lock.json", "README.md"])
def test_links_under_our_names_are_refused(fakes: ModuleType, tmp_path: Path, name: str) -> None:
    root, target = tmp_path / "root", tmp_path / "precious"
    root.mkdir()
    target.write_text("keep me")
    (root / name).symlink_to(target)
    with pytest.raises(InputError, match="symbolic link"):
        create_or_open(root, "x", fakes.lock(3))
    assert target.read_text() == "keep me"


def test_the_dataset_itself_may_not_be_a_link(fakes: ModuleType, dataset: Path, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(dataset)
    with pytest.raises(InputError, match="symbolic link"):
        create_or_open(tmp_path / "link", "x", fakes.lock(18))


def test_no_dataset_is_told_as_such(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no dataset at"):
        info(tmp_path / "nowhere")


def test_only_whole_clips_count_as_finished(fakes: ModuleType, dataset: Path) -> None:
    jobs = fakes.jobs(6)
    everything = {j.name for j in jobs}
    assert finished(dataset) == everything
    shard = dataset / jobs[0].shard
    shard.write_bytes(shard.read_bytes()[:-1])
    (dataset / jobs[1].shard).unlink()
    receipt = bytearray((dataset / jobs[2].receipt).read_bytes())
    receipt[len(receipt) // 2] ^= 1
    (dataset / jobs[2].receipt).write_bytes(receipt)
    (dataset / jobs[3].receipt).write_bytes((dataset / jobs[3].receipt).read_bytes()[:-5])
    assert finished(dataset) == everything - {j.name for j in jobs[:4]}
    fakes.make(dataset, 6)
    assert finished(dataset) == everything


def test_a_long_clip_counts_as_finished_too(fakes: ModuleType, dataset: Path) -> None:
    """65 frames, as a real clip has: its receipt is some fifty times as long."""
    job = fakes.jobs(1, pairs=64)[0]
    commit_clip(dataset, fakes.record(job), fakes.encoded(job), fingerprint="f")
    assert len((dataset / job.receipt).read_bytes()) > 80_000
    assert len(finished(dataset)) == 6


def test_quarantined_clips_are_named(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "d", 4, done=False)
    victim = fakes.jobs(4)[2]
    (root / victim.receipt).unlink()
    summary = finish(root, fakes.jobs(4))
    assert summary.missing == (victim.name,)
    assert not summary.complete
    assert summary.clips == 3
    fakes.make(root, 4)
    assert info(root).complete
    assert fakes.tree(root) == fakes.tree(fakes.make(tmp_path / "clean", 4))


def test_finish_refuses_nonsense(fakes: ModuleType, dataset: Path, tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="the plan says"):
        finish(dataset, fakes.jobs(6, pairs=2))
    empty = tmp_path / "empty"
    empty.mkdir()
    create_or_open(empty, "x", fakes.lock(3))
    with pytest.raises(InputError, match="no finished clip"):
        finish(empty, fakes.jobs(1))


def test_ids_depend_on_what_decides_samples_only() -> None:
    recipe = {"map": "city", "seed": 0, "camera": {"netd_mk": 50.0}}
    same = {
        "seed": 0,
        "camera": {"netd_mk": 50.0},
        "map": "city",
        "pairs": 8000,
        "out": "x",
        "jobs": 3,
        "engine": "ray",
    }
    assert recipe_id(recipe, 1) == recipe_id(same, 1)
    others = [
        recipe_id({**recipe, "seed": 1}, 1),
        recipe_id(recipe, 2),
        recipe_id({**recipe, "map": "field"}, 1),
    ]
    assert len({recipe_id(recipe, 1), *others}) == 4
    assert fingerprint_id({"a": "1", "b": "2"}) == fingerprint_id({"b": "2", "a": "1"})


def test_content_id_is_of_decoded_arrays_not_of_files(
    fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another compressor gives other shards and the same content."""
    from scenegen_datasets.codecs import tiff

    a = fakes.make(tmp_path / "a", 2)
    monkeypatch.setattr(tiff, "_FLOAT_PREDICTOR", 1)
    b = fakes.make(tmp_path / "b", 2)
    one, two = (json.loads((d / "dataset.json").read_bytes()) for d in (a, b))
    assert one["sums"] != two["sums"]
    assert one["content_id"] == two["content_id"]


def test_content_id_changes_with_any_array_name_or_clip(fakes: ModuleType, pristine: Path) -> None:
    receipts = [read_receipt(pristine, job.receipt) for job in fakes.jobs(3)]
    digests = [clip_digest(r) for r in receipts]
    first = receipts[0].frames[0]
    changed = replace(first, digests={**first.digests, "depth": "0" * 64})
    other = clip_digest(replace(receipts[0], frames=(changed, *receipts[0].frames[1:])))
    renamed = clip_digest(replace(receipts[0], clip=receipts[1].clip))
    variants = [digests, digests[:2], digests[::-1], [other, *digests[1:]], [renamed, *digests[1:]]]
    assert len({content_id(v) for v in variants}) == len(variants)


def test_a_finish_that_dies_halfway_leaves_no_claim_of_completeness(
    fakes: ModuleType, dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each file but the last may be new while others are old; then nothing may say that all is there."""
    from scenegen_datasets import finish as module

    before = fakes.tree(dataset)
    names: list[str] = []

    def failing(path: Path, data: bytes) -> None:
        names.append(path.name)
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "write_atomic", failing)
    with pytest.raises(KeyboardInterrupt):
        finish(dataset, fakes.jobs(5))
    assert names == ["clips.jsonl"]
    assert not (dataset / "dataset.json").exists()
    monkeypatch.undo()
    finish(dataset, fakes.jobs(6))
    assert fakes.tree(dataset) == before


def test_the_lock_is_canonical_and_holds_no_time_or_place(fakes: ModuleType, pristine: Path) -> None:
    lock = read_lock(pristine)
    assert canonical(lock)
    assert "out" not in lock["recipe"] and "jobs" not in lock["recipe"]
    assert {"numpy", "cv2", "OpenEXR", "cpu", "mitsuba"} <= set(lock["fingerprint"])
    assert all("unknown" not in v for v in lock["fingerprint"].values())
