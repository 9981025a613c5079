"""Whatever is damaged, missing, swapped or added is found, and named."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.canonical import canonical
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.index import rows_of
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.seal import unsealed
from scenegen_datasets.verify import verify

Found = Callable[..., dict[str, str]]

FILES = [
    "dataset.json",
    "recipe.yaml",
    "recipe.lock.json",
    "clips.jsonl",
    "index.npy",
    "README.md",
    "croissant.json",
    "MANIFEST.sha256",
    "receipts/val/city-00001/001.json",
    "shards/test/city-00002/000.tar",
]


def test_every_kind_of_file_is_covered(fakes: ModuleType, pristine: Path) -> None:
    """The list above holds one file of each kind there is."""
    kinds = {p.split("/")[0] for p in fakes.tree(pristine)}
    assert kinds == {p.split("/")[0] for p in FILES}


def test_a_sound_dataset_has_no_findings(pristine: Path) -> None:
    report = verify(pristine)
    assert report.ok and report.findings == ()
    assert (report.clips, report.frames) == (6, 24)
    told: list[tuple[int, int]] = []
    parallel = verify(pristine, jobs=2, progress=lambda done, total: told.append((done, total)))
    assert parallel == report
    assert told == [(k, 6) for k in range(1, 7)]
    assert verify(pristine, quick=True).ok


@pytest.mark.parametrize("name", FILES)
def test_a_flipped_bit_is_found_and_named(dataset: Path, found: Found, name: str) -> None:
    path = dataset / name
    data = path.read_bytes()
    rng = np.random.default_rng(len(name))
    for at in rng.integers(0, len(data), 6):
        path.write_bytes(data[:at] + bytes([data[at] ^ (1 << int(rng.integers(8)))]) + data[at + 1 :])
        try:
            assert any(name in file for file in found(dataset)), f"byte {at} of {name}"
        except DatasetError as error:  # a lock that cannot even be read
            assert name in str(error)
    path.write_bytes(data)
    assert found(dataset) == {}


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("how", ["missing", "short", "longer", "empty"])
def test_missing_short_and_grown_files_are_found_quickly(
    dataset: Path, found: Found, name: str, how: str
) -> None:
    path = dataset / name
    data = path.read_bytes()
    path.unlink()
    if how != "missing":
        path.write_bytes({"short": data[:-7], "longer": data + b"\n\n", "empty": b""}[how])
    try:
        assert any(name in file for file in found(dataset, quick=True)), how
    except (InputError, DatasetError) as error:
        assert name in str(error)


def test_every_byte_of_a_shard_counts(dataset: Path, found: Found, fakes: ModuleType) -> None:
    """Headers, pixels, padding, trailer: one flip in each region, each named with the member it hits."""
    job = fakes.jobs(1)[0]
    path = dataset / job.shard
    data = path.read_bytes()
    receipt = read_receipt(dataset, job.receipt)
    frame = receipt.frames[2]
    for suffix, span in frame.members.items():
        for at in (
            span.offset - 512,
            span.offset - 400,
            span.offset + span.size // 2,
            span.offset + span.size,
        ):
            path.write_bytes(data[:at] + bytes([data[at] ^ 16]) + data[at + 1 :])
            names = found(dataset)
            inside = at < span.offset + span.size or span.size % 512
            assert not inside or f"{job.shard}: {frame.key}.{suffix}" in names, (suffix, at)
            assert job.shard in names
    path.write_bytes(data[:-1] + b"\1")
    assert "does not end" in found(dataset)[job.shard]


def test_strangers_links_and_orphans_are_named(dataset: Path, found: Found) -> None:
    (dataset / "notes.txt").write_text("x")
    (dataset / "shards/train/city-00000/002.tar").write_bytes(b"x")
    (dataset / "shards/train/.000.tar.1-1.partial").touch()
    (dataset / "linked").symlink_to("/etc/hostname")
    names = found(dataset)
    assert set(names) == {
        "notes.txt",
        "shards/train/city-00000/002.tar",
        "shards/train/.000.tar.1-1.partial",
        "linked",
    }
    assert "link" in names["linked"] and "killed writer" in names["shards/train/.000.tar.1-1.partial"]


def test_what_lives_beside_a_dataset_is_tolerated(dataset: Path, found: Found) -> None:
    (dataset / "run.log.jsonl").write_text("{}\n")
    (dataset / ".gitattributes").write_text("*.tar filter=lfs\n")
    (dataset / ".git").mkdir()
    (dataset / ".git/config").write_text("x")
    (dataset / "preview").mkdir()
    (dataset / "preview/sheet.png").write_bytes(b"x")
    assert found(dataset) == {}


def test_swapped_shards_and_receipts_are_found(dataset: Path, found: Found, fakes: ModuleType) -> None:
    a, b = fakes.jobs(2)
    for one, two in ((a.shard, b.shard), (a.receipt, b.receipt)):
        (dataset / one).rename(dataset / "hold")
        (dataset / two).rename(dataset / one)
        (dataset / "hold").rename(dataset / two)
    names = found(dataset)
    assert "speaks of" in names[a.receipt] and "speaks of" in names[b.receipt]


def test_a_clip_lost_with_its_receipt_is_missed(dataset: Path, found: Found, fakes: ModuleType) -> None:
    job = fakes.jobs(6)[3]
    (dataset / job.shard).unlink()
    (dataset / job.receipt).unlink()
    names = found(dataset, quick=True)
    assert {job.shard, job.receipt, "dataset.json", "clips.jsonl", "index.npy"} <= set(names)


def test_a_growing_dataset_says_so(fakes: ModuleType, tmp_path: Path, found: Found) -> None:
    root = fakes.make(tmp_path / "d", 2, done=False)
    assert list(found(root)) == ["dataset.json"]
    assert "still grows" in found(root)["dataset.json"]


def test_random_metadata_damage_is_always_found(dataset: Path, found: Found) -> None:
    """A few hundred flips over receipts: SHA-256 leaves no luck to an unlucky position."""
    path = dataset / FILES[8]
    data = path.read_bytes()
    rng = np.random.default_rng(8)
    for at in rng.integers(0, len(data), 300):
        with pytest.raises(DatasetError):
            flipped = bytearray(data)
            flipped[at] ^= 1 << rng.integers(8)
            unsealed("receipt", bytes(flipped), "x")


def test_a_dying_decoder_is_a_finding(
    fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that dies on one clip costs a finding, not the verification."""
    import scenegen_datasets.verify as module

    monkeypatch.setattr(module, "check_clip", die_on_one)
    report = verify(fakes.make(tmp_path / "d", 2), jobs=2)
    assert [f.file for f in report.findings if "died" in f.reason] == ["receipts/train/city-00000/001.json"]


def die_on_one(root: Path, path: str, quick: bool) -> object:
    from scenegen_datasets.verify.clip import check_clip

    if "00000/001" in path:
        os.abort()
    return check_clip(root, path, quick)


def test_rows_and_receipts_tell_the_same(pristine: Path, fakes: ModuleType) -> None:
    receipt = read_receipt(pristine, fakes.jobs(1)[0].receipt)
    rows = rows_of(receipt)
    assert rows["depth_offset"].tolist() == [f.members["depth.tiff"].offset for f in receipt.frames]
    assert rows["is_pair"].tolist() == [False, True, True, True]
    assert canonical({"a": receipt.clip.to_dict()})
    assert not rows["normal_size"].any()


def test_a_copy_of_the_tree_is_as_sound(pristine: Path, tmp_path: Path, found: Found) -> None:
    """Nothing in a dataset knows where it lies or when it was written."""
    copy = tmp_path / "elsewhere ä b"
    shutil.copytree(pristine, copy, copy_function=shutil.copyfile)
    assert found(copy) == {}
