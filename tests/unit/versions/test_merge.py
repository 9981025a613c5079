"""Several datasets as one: the same whole in any order, nothing shared by accident, no half of it that looks whole."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.info import info
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.lock import make_lock
from scenegen_datasets.store import create_or_open, read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.versions import merge as module
from scenegen_datasets.versions.merge import merge
from scenegen_datasets.versions.parts import recipe_behind
from scenegen_datasets.versions.release import release

SENSOR = {"scale_K": [233.0, 423.0], "linear_in": "radiance", "netd_mk": 50.0}


def make(fakes: ModuleType, root: Path, map: str, clips: int = 6, **more: Any) -> Path:
    """A dataset of another map; `more` are recipe keys, and ``change``, which alters a clip's record."""
    change = more.pop("change", lambda record: record)
    shape = more.pop("shape", fakes.SHAPE)
    camera = {"width_px": shape[1], "band_um": [8.0, 14.0]}
    recipe = {
        "pairs": clips * fakes.PAIRS,
        "map": [map],
        "seed": 0,
        "sensor": SENSOR,
        "camera": camera,
        **more,
    }
    lock = make_lock(recipe, name=root.name, scene_semantics=3, render=fakes.RENDER)
    plan = [replace(job, map=map) for job in fakes.jobs(clips)]
    root.mkdir(exist_ok=True)
    with DirectoryLock(root):
        create_or_open(root, f"map: {map}\n", lock)
        for job in plan:
            frames = fakes.encoded(job, shape=shape)
            record = fakes.record(job, shape)
            record = change(replace(record, weather={**record.weather, "cloud_fraction": 0.5}))
            fakes.commit_clip(root, record, frames, fingerprint=fakes.FINGERPRINT)
        fakes.finish(root, plan)
    return root


@pytest.fixture(scope="module")
def parts(fakes: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Three maps, read-only."""
    base = tmp_path_factory.mktemp("parts")
    return {
        name: make(fakes, base / name, name, clips, seed=seed)
        for name, clips, seed in (("city", 6, 0), ("field", 4, 1), ("coastline", 2, 0))
    }


@pytest.fixture(autouse=True)
def without_pictures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the first test draws them: they are most of the time of a merge of such small clips."""
    if "verifies_loads" not in request.node.name:
        monkeypatch.setattr(module, "write_preview", lambda _: None)


def whole(parts: dict[str, Path], out: Path, *names: str, copy: bool = False) -> Path:
    merge(out, [parts[name] for name in names], copy=copy)
    return out


def test_a_merged_dataset_verifies_loads_and_keeps_its_splits(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    before = {name: fakes.tree(root) for name, root in parts.items()}
    out = whole(parts, tmp_path / "all", "city", "field", "coastline")
    assert verify(out).findings == ()
    assert (out / "preview" / "contact_sheet.png").is_file()
    facts = info(out)
    assert (facts.clips, facts.pairs, facts.complete, facts.version) == (12, 36, True, "1.0.0")
    assert facts.splits == {
        split: sum(info(root).splits[split] for root in parts.values()) for split in ("train", "val", "test")
    }
    pairs = PairDataset(out, layers=("thermal", "depth", "flow"), seq_length=2)
    found = {tuple(sample["key"]): sample for sample in pairs}
    assert len(found) == 24
    for root in parts.values():
        for sample in PairDataset(root, layers=("thermal", "depth", "flow"), seq_length=2):
            other = found[tuple(sample["key"])]
            assert sample["split"] == other["split"] and sample["facts"] == other["facts"]
            np.testing.assert_array_equal(sample["depth"], other["depth"])
    assert {name: fakes.tree(root) for name, root in parts.items()} == before


@pytest.mark.parametrize("copy", [False, True])
def test_shards_are_links_unless_copies_are_asked_for(
    parts: dict[str, Path], tmp_path: Path, copy: bool
) -> None:
    merged = merge(tmp_path / "all", [parts["city"], parts["field"]], copy=copy)
    assert (merged.linked, merged.copied) == ((0, 10) if copy else (10, 0))
    for shard in parts["field"].rglob("*.tar"):
        there = tmp_path / "all" / shard.relative_to(parts["field"])
        assert there.samefile(shard) != copy and there.read_bytes() == shard.read_bytes()


def test_where_no_link_can_be_made_shards_are_copied(
    parts: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(18, "Invalid cross-device link")

    monkeypatch.setattr(module.os, "link", refuse)
    assert merge(tmp_path / "all", [parts["city"], parts["field"]]).copied == 10
    assert verify(tmp_path / "all").ok


def test_order_and_steps_of_merging_do_not_matter(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    one = whole(parts, tmp_path / "1" / "all", "city", "field", "coastline")
    two = whole(parts, tmp_path / "2" / "all", "coastline", "city", "field")
    inner = {"inner": whole(parts, tmp_path / "inner", "coastline", "field"), **parts}
    three = whole(inner, tmp_path / "3" / "all", "inner", "city")
    assert fakes.tree(one) == fakes.tree(two)
    assert info(three).content_id == info(one).content_id
    assert read_lock(three) == read_lock(one)
    assert info(one).content_id != info(inner["inner"]).content_id


def test_where_every_clip_comes_from_is_kept(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    out = whole(parts, tmp_path / "all", "field", "city")
    told = json.loads((out / "dataset.json").read_text())
    assert {(p["name"], p["counts"]["clips"]) for p in told["parts"]} == {("city", 6), ("field", 4)}
    assert {p["content_id"] for p in told["parts"]} == {info(parts[n]).content_id for n in ("city", "field")}
    lock = read_lock(out)
    job = replace(fakes.jobs(1)[0], map="field")
    assert recipe_behind(lock, job)["recipe"] == read_lock(parts["field"])["recipe"]
    plain = read_lock(parts["city"])
    assert recipe_behind(plain, fakes.jobs(1)[0]) is plain
    with pytest.raises(DatasetError, match="no part"):
        recipe_behind(lock, replace(job, world=9))
    assert lock["recipe"]["map"] == ["city", "field"] and lock["recipe"]["sensor"] == SENSOR
    assert "seed" not in lock["recipe"]


def test_a_merged_dataset_is_released_and_merged_again_but_not_grown(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    out = whole(parts, tmp_path / "all", "city", "field")
    release(out, "1.0.0")
    assert verify(out).ok
    with pytest.raises(InputError, match="merged from other datasets and does not grow"):
        create_or_open(out, "x", fakes.lock(99))


@pytest.mark.parametrize("parts_told", [3, [3], [{}], [{"worlds": {"city": [["a", 1]]}}]], ids=str)
def test_a_lock_whose_parts_make_no_sense_is_refused(
    fakes: ModuleType, tmp_path: Path, parts_told: Any
) -> None:
    root = fakes.make(tmp_path / "dataset", 2)
    path = root / "recipe.lock.json"
    path.write_bytes(pretty({**json.loads(path.read_bytes()), "parts": parts_told}))
    with pytest.raises(DatasetError, match=r"recipe.lock.json: not a recipe lock \(parts"):
        verify(root)


def test_collisions_are_refused_with_the_clip_and_where_it_is(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    again = make(fakes, tmp_path / "again", "field", 2, seed=1)
    with pytest.raises(InputError, match=rf"clip field-00000-000 is in {parts['field']} and in {again}"):
        merge(tmp_path / "all", [parts["field"], again])
    with pytest.raises(InputError, match="clip city-00000-000 is in"):
        merge(tmp_path / "all", [parts["city"], parts["city"]])
    assert not (tmp_path / "all").exists()


def test_two_worlds_of_one_name_are_refused(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    """Another seed, and other clips of world 0: no clip collides, the world does."""
    root = tmp_path / "other"
    root.mkdir()
    recipe = {**read_lock(parts["city"])["recipe"], "seed": 9}
    lock = make_lock(recipe, name="other", scene_semantics=3, render=fakes.RENDER)
    jobs = [replace(job, clip=job.clip + 5) for job in fakes.jobs(2)]
    create_or_open(root, "x", lock)
    for job in jobs:
        fakes.commit_clip(root, fakes.record(job), fakes.encoded(job), fingerprint=fakes.FINGERPRINT)
    fakes.finish(root, jobs)
    with pytest.raises(
        InputError, match=r"city-00000 is one world in .* and another in .*clip city-00000-005"
    ):
        merge(tmp_path / "all", [parts["city"], root])


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"shape": (12, 20)}, r"differ in grid.width_px: 16 -> 20"),
        ({"change": lambda r: replace(r, band_um=(7.5, 13.5))}, r"band_um: \[8.0,14.0\] -> \[7.5,13.5\]"),
        (
            {"change": lambda r: replace(r, sensor={**r.sensor, "low_radiance": 1.0})},
            "sensor.low_radiance: 11.2 -> 1.0",
        ),
        ({"sensor": {**SENSOR, "netd_mk": 35.0}}, "sensor.netd_mk: 50.0 -> 35.0"),
    ],
    ids=["grid", "band", "scale", "noise"],
)
def test_what_cannot_be_read_as_one_is_refused(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path, more: dict[str, Any], message: str
) -> None:
    other = make(fakes, tmp_path / "other", "field", 2, **more)
    with pytest.raises(InputError, match=message):
        merge(tmp_path / "all", [parts["city"], other])
    assert not (tmp_path / "all").exists()


def test_a_part_may_not_train_on_what_another_holds_out(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    """The city's clips 0 and 1 are for training, at hours 0 and 5.5; 2 and 3 for validation, at 11 and 16.5."""
    strict = make(fakes, tmp_path / "strict", "field", 2, splits={"test_hours": [20, 23], "test_weather": []})
    out = tmp_path / "all"
    merge(out, [parts["city"], strict])
    told = json.loads((out / "dataset.json").read_text())["split_rule"]
    assert told["held_out_for_test"]["hours"] == [[20.0, 23.0]]
    assert verify(out).ok
    stricter = make(fakes, tmp_path / "stricter", "field", 2, splits={"test_hours": [10, 12]})
    with pytest.raises(
        InputError, match=rf"{parts['city']}: city-00001-000 is in split val and shows .* hour 11"
    ):
        merge(tmp_path / "other", [parts["city"], stricter])


def test_places_that_cannot_be_merged_into_or_from(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    city, field = str(parts["city"]), str(parts["field"])
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "thesis.tex").write_text("x")
    growing = fakes.make(tmp_path / "growing", 2, done=False)
    cases = [
        ([str(tmp_path / "all"), city], "at least two datasets"),
        ([str(tmp_path / "all"), city, str(tmp_path / "nowhere")], "no dataset at"),
        ([str(tmp_path / "all"), city, str(growing)], "is not finished"),
        ([str(tmp_path / "thesis"), city, field], "thesis.tex"),
        ([city, city, field], "lie in one another"),
        ([f"{city}/shards/all", city, field], "lie in one another"),
        ([str(growing), city, field], "holds a dataset already"),
    ]
    for arguments, message in cases:
        assert main(["merge", *arguments]) == 2
        said = capsys.readouterr().err.strip()
        assert message in said and "\n" not in said
    assert not (tmp_path / "all").exists()


def test_a_damaged_part_is_found_while_it_is_copied(
    parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    field = Path(shutil.copytree(parts["field"], tmp_path / "field"))
    shard = next(field.rglob("*.tar"))
    data = bytearray(shard.read_bytes())
    data[len(data) // 2] ^= 1
    shard.write_bytes(data)
    with pytest.raises(DatasetError, match=f"{shard.name}: damaged"):
        merge(tmp_path / "copied", [parts["city"], field], copy=True)
    assert not (tmp_path / "copied" / "dataset.json").exists()
    assert main(["merge", str(tmp_path / "linked"), str(parts["city"]), str(field), "--jobs", "1"]) == 1
    assert "verify found" in capsys.readouterr().err


def test_the_same_merge_again_writes_nothing_and_another_is_refused(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = whole(parts, tmp_path / "all", "city", "field")
    before = fakes.tree(out)
    merged = merge(out, [parts["field"], parts["city"]])
    assert (merged.linked, merged.copied) == (0, 0)
    with pytest.raises(InputError, match="holds another merge already"):
        merge(out, [parts["field"], parts["coastline"]])
    assert fakes.tree(out) == before
    with DirectoryLock(out), pytest.raises(InputError, match="is being written"):
        merge(out, [parts["field"], parts["city"]])
    assert main(["merge", str(out), *map(str, (parts["city"], parts["field"])), "--jobs", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verified"] is True


def test_killed_at_any_step_a_merge_never_looks_whole_and_goes_on(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path, dies: Callable[..., bool]
) -> None:
    roots = [parts["field"], parts["coastline"]]
    merge(tmp_path / "clean" / "all", roots)
    clean = fakes.tree(tmp_path / "clean" / "all")
    kinds = set()
    for number, step in enumerate((*range(1, 30, 3), *range(30, 170, 9))):
        out = tmp_path / f"{step}" / "all"
        died = dies(step, lambda out=out: merge(out, roots))
        if not died:
            kinds.add("lived")
            break
        if out.exists() and (out / "dataset.json").exists():
            kinds.add("whole")
            assert {k: v for k, v in fakes.tree(out).items() if not k.startswith(".")} == clean
        else:
            kinds.add("unfinished")
        if number % 3 == 0 and out.exists():
            after = Path(shutil.copytree(out, tmp_path / f"after{step}" / "all"))
            merge(after, roots)
            assert fakes.tree(after) == clean
    assert kinds >= {"unfinished", "lived"} and number > 8
