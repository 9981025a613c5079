"""Whatever is damaged, missing, swapped, added or forged is found, and named."""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import tarfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.canonical import canonical, pretty
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.index import ROW, rows_of
from scenegen_datasets.invariants import violations
from scenegen_datasets.layers import LAYERS
from scenegen_datasets.manifest import manifest_bytes, read_manifest
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.seal import sealed, unsealed, with_seal
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
    from dataclasses import replace

    from scenegen_datasets.commit import commit_clip
    from scenegen_datasets.finish import finish

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


def test_a_path_out_of_the_dataset_in_the_manifest_is_refused(dataset: Path, found: Found) -> None:
    path = dataset / "MANIFEST.sha256"
    good = path.read_bytes()
    for evil in ("../secret", "/etc/passwd", "a/../../b", "./x", "a//b", "x\\y", ""):
        path.write_bytes(good + f"{'0' * 64}  {evil}\n".encode())
        assert "not a line of a manifest" in found(dataset, quick=True)["MANIFEST.sha256"], evil


def hostile_tar(kind: str, honest: bytes) -> bytes:
    """A tar of the honest one's length that starts with something no dataset holds."""
    buffer = io.BytesIO()
    with tarfile.open(
        fileobj=buffer, mode="w", format=tarfile.PAX_FORMAT if kind == "pax" else tarfile.USTAR_FORMAT
    ) as tar:
        info = tarfile.TarInfo(
            {"dotdot": "../../evil", "absolute": "/tmp/evil"}.get(kind, "city-00000-000-0000.thermal.png")
        )
        if kind in ("symlink", "hardlink"):
            info.type = tarfile.SYMTYPE if kind == "symlink" else tarfile.LNKTYPE
            info.linkname = "/etc/passwd"
        elif kind == "device":
            info.type = tarfile.CHRTYPE
        elif kind == "pax":
            info.pax_headers = {"comment": "x" * 50}
        tar.addfile(info)
    data = buffer.getvalue()[:1024]
    return data + honest[len(data) :]


@pytest.mark.parametrize("kind", ["dotdot", "absolute", "symlink", "hardlink", "device", "pax"])
def test_hostile_tars_are_read_by_offset_only(
    dataset: Path, found: Found, fakes: ModuleType, kind: str, tmp_path: Path
) -> None:
    """Even when the receipt's sums are forged to match."""
    job = fakes.jobs(1)[0]
    path = dataset / job.shard
    evil = hostile_tar(kind, path.read_bytes())
    path.write_bytes(evil)
    forge(dataset, job, lambda b: b["shard"].update(sha256=hashlib.sha256(evil).hexdigest()))  # type: ignore[attr-defined]
    names = found(dataset)
    assert "does not stand in the tar" in names[f"{job.shard}: {job.key(0)}.thermal.png"]
    assert not (tmp_path / "evil").exists() and not (dataset.parent / "evil").exists()


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


def arrays(fakes: ModuleType) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(3)
    frame, reading = fakes.frame(rng, extra=True), fakes.reading(rng)
    pictures = {n: getattr(frame, n).copy() for n in LAYERS if n not in ("thermal", "imu")}
    return pictures | {"thermal": reading.counts, "imu": fakes.imu(3)}


def put(name: str, at: tuple[int, ...], value: float) -> Callable[[dict[str, np.ndarray]], None]:
    def change(layers: dict[str, np.ndarray]) -> None:
        layers[name][at] = value

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (put("thermal", (5, 5), 16384), "counts above 16383"),
        (put("depth", (5, 5), 0.0), "depth: not positive"),
        (put("depth", (5, 5), -1.0), "depth: not positive"),
        (put("depth", (5, 5), np.nan), "depth: not positive"),
        (put("depth", (5, 5), np.inf), "exactly in the sky"),
        (put("depth", (0, 5), 10.0), "exactly in the sky"),
        (put("radiance", (5, 5), np.nan), "radiance"),
        (put("radiance", (5, 5), np.inf), "radiance"),
        (put("radiance", (5, 5), 0.0), "radiance"),
        (put("temperature", (5, 5), np.nan), "temperature"),
        (put("temperature", (5, 5), -3.0), "temperature"),
        (put("temperature", (5, 5), 0.0), "temperature: 0 K"),
        (put("temperature", (0, 5), 280.0), "temperature: 0 K"),
        (put("semantic", (5, 5), 99), "class id 99"),
        (put("material", (5, 5), 0), "no material"),
        (put("material", (5, 5), 900), "material id 900"),
        (put("instance", (0, 5), 7), "sky has an instance"),
        (put("flow", (0, 0, 0), np.inf), "flow: infinite"),
        (put("flow_back", (0, 0, 1), -np.inf), "flow_back: infinite"),
        (put("flow", (5, 5, 0), 12.0), "outside the other image"),
        (put("flow", (5, 5, 1), np.nan), "outside the other image"),
        (put("normal", (5, 5, 2), 3.0), "unit length"),
        (put("imu", (4, 2), np.nan), "imu: not finite"),
        (put("imu", (4, 0), 0.0), "imu: time does not rise"),
    ],
)
def test_each_invariant_has_teeth(
    fakes: ModuleType, change: Callable[[dict[str, np.ndarray]], None], reason: str
) -> None:
    layers = arrays(fakes)
    layers["covisible"][5, 5] = layers["covisible_back"][5, 5] = True
    assert violations(layers) == []
    change(layers)
    assert reason in "; ".join(violations(layers))


def test_nothing_forbidden_is_ever_encoded(fakes: ModuleType) -> None:
    from dataclasses import replace

    from scenegen_datasets.encode import encode_frame

    rng = np.random.default_rng(0)
    frame, reading = fakes.frame(rng), fakes.reading(rng)
    bad = frame.radiance.copy()
    bad[6, 6] = np.nan
    with pytest.raises(DatasetError, match="k-0: radiance"):
        encode_frame("k-0", replace(frame, radiance=bad), reading, fakes.meta(0))
    with pytest.raises(DatasetError, match="flow_back, normal asked for but not rendered"):
        encode_frame("k-0", frame, reading, fakes.meta(0), ("thermal", "flow_back", "normal"))
    with pytest.raises(DatasetError, match="one pixel grid"):
        encode_frame("k-0", frame, fakes.reading(rng, (3, 3)), fakes.meta(0))
    with pytest.raises(InputError, match="perhaps you meant 'depth'"):
        encode_frame("k-0", frame, reading, fakes.meta(0), ("deph",))


def test_a_copy_of_the_tree_is_as_sound(pristine: Path, tmp_path: Path, found: Found) -> None:
    """Nothing in a dataset knows where it lies or when it was written."""
    copy = tmp_path / "elsewhere ä b"
    shutil.copytree(pristine, copy, copy_function=shutil.copyfile)
    assert found(copy) == {}
