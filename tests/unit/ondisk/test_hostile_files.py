"""Files that mean harm are refused by name, whatever their sums say, and cost neither memory nor time."""

from __future__ import annotations

import hashlib
import json
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from hostile.documents import agree, clips, index_header
from hostile.members import FOREIGN, foreign_header
from scenegen.foundation.canonical import canonical
from scenegen.foundation.errors import DatasetError
from scenegen_datasets import PairDataset, tar
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.manifest import listable, read_manifest
from scenegen_datasets.push import push
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.seal import sealed, unsealed
from scenegen_datasets.source import open_source

Found = Callable[..., dict[str, str]]


@pytest.fixture
def little_memory() -> Iterator[None]:
    """At most 150 MB of Python objects: the largest file here is 25 MB, a list of its lines takes 200."""
    tracemalloc.start()
    yield
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 150e6, f"{peak / 1e6:.0f} MB"


@pytest.mark.parametrize(
    "evil",
    [
        "../secret",
        "/etc/passwd",
        "a/../../b",
        "./x",
        "a//b",
        "x\\y",
        "",
        "preview/con.png",
        "AUX",
        "lpt1.tar/x",
        "preview/x.",
        "a\u202eb",
        "<b>",
    ],
)
def test_a_path_that_is_no_file_below_the_dataset_is_refused(dataset: Path, found: Found, evil: str) -> None:
    assert not listable(evil)
    with (dataset / "MANIFEST.sha256").open("a", encoding="utf-8") as file:
        file.write(f"{'0' * 64}  {evil}\n")
    assert "not a line of a manifest" in found(dataset, quick=True)["MANIFEST.sha256"]


@pytest.mark.parametrize("path", ["preview/console.png", "shards/train/con-00000/000.tar", "a/b.c/d", ".x"])
def test_a_path_that_only_looks_like_one_is_not(path: str) -> None:
    assert listable(path)


@pytest.mark.parametrize("twin", ["README.md", "readme.MD"])
def test_one_file_named_twice_is_refused(dataset: Path, found: Found, twin: str) -> None:
    """Readers would take different sums for it; where letters have no case, one file would replace the other."""
    with (dataset / "MANIFEST.sha256").open("a", encoding="utf-8") as file:
        file.write(f"{'0' * 64}  {twin}\n")
    assert f"names {twin} twice" in found(dataset, quick=True)["MANIFEST.sha256"]


def test_pictures_that_are_one_file_elsewhere_are_listed_once(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "d", 1, done=False)
    (root / "preview").mkdir()
    for name in ("a.png", "A.png", "con.png"):
        (root / "preview" / name).write_bytes(b"x")
    fakes.make(root, 1)
    listed = [path for path in read_manifest(root / "MANIFEST.sha256") if path.startswith("preview/")]
    assert listed == ["preview/A.png"]


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize("name", ["MANIFEST.sha256", "clips.jsonl"])
def test_a_file_of_line_ends_costs_no_memory(dataset: Path, found: Found, name: str) -> None:
    """As a list of lines it would take ten times its size, as findings hundreds."""
    (dataset / name).write_bytes(b"\n" * (24 << 20))
    if name == "clips.jsonl":
        agree(dataset, (name,))
        with pytest.raises(DatasetError, match="its size is not that of 6 clips"):
            open_source(dataset, allow_partial=False)
    reasons = found(dataset, quick=True)[name]
    assert reasons.count("\n") < 1100


@pytest.mark.parametrize("kind", FOREIGN)
def test_headers_of_other_tars_are_not_read(
    dataset: Path, found: Found, fakes: ModuleType, kind: str, tmp_path: Path
) -> None:
    """Even when the receipt's sums are forged to match: members are read by offset, and nothing is extracted."""
    job = fakes.jobs(1)[0]
    path, receipt = dataset / job.shard, read_receipt(dataset, job.receipt)
    span = receipt.frames[0].members["thermal.png"]
    evil = bytearray(path.read_bytes())
    evil[:512] = foreign_header(kind, f"{job.key(0)}.thermal.png", span.size)
    path.write_bytes(evil)
    body = unsealed("receipt", (dataset / job.receipt).read_bytes(), "")
    body["shard"]["sha256"] = hashlib.sha256(evil).hexdigest()
    (dataset / job.receipt).write_bytes(sealed("receipt", body))
    assert "does not stand in the tar" in found(dataset)[f"{job.shard}: {job.key(0)}.thermal.png"]
    assert not list(tmp_path.rglob("*evil*")) and not list(dataset.parent.glob("*.png"))


def test_an_honest_header_is_the_one_of_the_format(fakes: ModuleType, dataset: Path) -> None:
    """The control of the above: the library of Python reads the header that this package writes."""
    import tarfile

    job = fakes.jobs(1)[0]
    with tarfile.open(dataset / job.shard) as archive:
        first = archive.next()
    assert first is not None and first.isreg()
    assert tar.header(first.name, first.size) == (dataset / job.shard).read_bytes()[: tar.BLOCK]


def test_a_huge_sparse_shard_costs_no_memory(dataset: Path, found: Found, fakes: ModuleType) -> None:
    job = fakes.jobs(1)[0]
    with (dataset / job.shard).open("r+b") as file:
        file.truncate(1 << 40)
    assert str(1 << 40) in found(dataset)[job.shard]


def test_deep_json_is_refused(dataset: Path, found: Found, fakes: ModuleType) -> None:
    job = fakes.jobs(1)[0]
    body = b'{"a":' * 20_000 + b"1" + b"}" * 20_000
    sum_ = hashlib.sha256(body).hexdigest().encode()
    (dataset / job.receipt).write_bytes(b'{"receipt":' + body + b',"sha256":"' + sum_ + b'"}\n')
    assert "nested too deeply" in found(dataset)[job.receipt]
    (dataset / "dataset.json").write_bytes(b"[" * 1_000_000)
    assert "nested too deeply" in found(dataset)["dataset.json"]


@pytest.mark.parametrize("seed", range(12))
def test_an_index_of_another_kind_is_never_parsed(dataset: Path, found: Found, seed: int) -> None:
    """Objects to unpickle, shapes below zero or beyond memory, headers of other versions: the header is compared."""
    index_header(dataset, np.random.default_rng(seed))
    assert "not an index of 24 frames of this version" in found(dataset, quick=True)["index.npy"]
    with pytest.raises(DatasetError, match="not an index"):
        PairDataset(dataset)


@pytest.mark.parametrize("name", ["shards/train/city-00000/000.tar", "README.md"])
def test_a_terabyte_of_nothing_is_not_pushed(dataset: Path, tmp_path: Path, name: str) -> None:
    """Reading it to the end would take an hour."""
    with (dataset / name).open("r+b") as file:
        file.truncate(1 << 40)
    with pytest.raises(DatasetError, match="other sizes than"):
        push(dataset, f"file://{tmp_path}/there")
    assert not (tmp_path / "there").exists()


def test_what_lies_behind_a_link_is_not_pushed(dataset: Path, tmp_path: Path) -> None:
    (dataset / "shards/val").rename(tmp_path / "elsewhere")
    (dataset / "shards/val").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DatasetError, match=r"missing \(or not a plain file\); run `scenegen repair`"):
        push(dataset, f"file://{tmp_path}/there")


@pytest.mark.parametrize("seed", range(25))
def test_a_forged_clip_has_a_sound_record_or_none(dataset: Path, seed: int) -> None:
    """Nothing else is raised, and what passes can be written again: those who merge or sense it write it."""
    clips(dataset, np.random.default_rng(seed))
    try:
        source = open_source(dataset, allow_partial=False)
        for k in range(len(source.lines)):
            record = source.record(k)
            assert ClipRecord.from_dict(json.loads(canonical(record.to_dict()))) == record
    except DatasetError as error:
        assert "clips.jsonl" in str(error)
