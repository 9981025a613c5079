"""What cannot become one dataset: refused in one line, with what stands in the way and where."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_cli.main import main
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.lock import make_lock
from scenegen_datasets.store import create_or_open, read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.versions.merge import merge


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
    make_map: Callable[..., Path], fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    again = make_map(tmp_path / "again", "field", 2, seed=1)
    with pytest.raises(
        InputError,
        match=rf"clip field-00000-000 of seed 1 is in {parts['field']} and in {again}, by the same recipe",
    ):
        merge(tmp_path / "all", [parts["field"], again])
    with pytest.raises(InputError, match=f"{parts['city']} is named twice"):
        merge(tmp_path / "all", [parts["city"], parts["field"], parts["city"]])
    assert not (tmp_path / "all").exists()


def test_one_place_twice_is_refused_whatever_its_clips(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    """The same seed, another climate, and other clips of world 0: no clip collides, the world does."""
    root = tmp_path / "other"
    root.mkdir()
    recipe = {**read_lock(parts["city"])["recipe"], "climate": {"hour": [0.0, 4.0]}}
    lock = make_lock(recipe, name="other", scene_semantics=3, render=fakes.RENDER)
    jobs = [replace(job, clip=job.clip + 5) for job in fakes.jobs(2)]
    create_or_open(root, "x", lock)
    for job in jobs:
        fakes.commit_clip(root, fakes.record(job), fakes.encoded(job), fingerprint=fakes.FINGERPRINT)
    fakes.finish(root, jobs)
    with pytest.raises(
        InputError,
        match=r"city-00000 of seed 0 is in .* and, by another recipe, in .*: one place twice; .*--seed",
    ):
        merge(tmp_path / "all", [parts["city"], root])


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"shape": (12, 20)},
            r"differ in grid.width_px: 16 -> 20; 'scenegen sense' may give both one camera",
        ),
        ({"layers": ("thermal", "depth", "flow")}, r"city stores covisible, instance, .*, .*other does not"),
        (
            {"layers": (*DEFAULT_LAYERS, "normal")},
            r"other stores normal, .*city does not; .* the same layers",
        ),
        ({"change": lambda r: replace(r, band_um=(7.5, 13.5))}, r"band_um: \[8.0,14.0\] -> \[7.5,13.5\]"),
        (
            {"change": lambda r: replace(r, sensor={**r.sensor, "low_radiance": 1.0})},
            "sensor.low_radiance: 11.2 -> 1.0",
        ),
        (
            {"sensor": {"scale_K": [233.0, 423.0], "linear_in": "radiance", "netd_mk": 35.0}},
            "recipe.sensor.netd_mk: 50.0 -> 35.0",
        ),
    ],
    ids=["grid", "fewer layers", "more layers", "band", "scale", "noise"],
)
def test_what_cannot_be_read_as_one_is_refused(
    make_map: Callable[..., Path],
    fakes: ModuleType,
    parts: dict[str, Path],
    tmp_path: Path,
    more: dict[str, Any],
    message: str,
) -> None:
    other = make_map(tmp_path / "other", "field", 2, **more)
    with pytest.raises(InputError, match=message):
        merge(tmp_path / "all", [parts["city"], other])
    assert not (tmp_path / "all").exists()


def test_a_part_may_not_train_on_what_another_holds_out(
    make_map: Callable[..., Path], fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    """The city's clips 0 and 1 are for training, at hours 0 and 5.5; 2 and 3 for validation, at 11 and 16.5."""
    strict = make_map(tmp_path / "strict", "field", 2, splits={"test_hours": [20, 23], "test_weather": []})
    out = tmp_path / "all"
    merge(out, [parts["city"], strict])
    told = json.loads((out / "dataset.json").read_text())["split_rule"]
    assert told["held_out_for_test"]["hours"] == [[20.0, 23.0]]
    assert verify(out).ok
    stricter = make_map(tmp_path / "stricter", "field", 2, splits={"test_hours": [10, 12]})
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
        ([city, city, field], "is one of the parts; merge into a directory of its own"),
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


def test_a_damaged_part_that_is_linked_leaves_nothing_that_looks_whole(
    parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Once the part is put right, which makes a new file of the shard, the same command finishes the whole."""
    field, out = Path(shutil.copytree(parts["field"], tmp_path / "field")), tmp_path / "all"
    shard = next(field.rglob("*.tar"))
    sound = shard.read_bytes()
    shard.write_bytes(sound[:700] + bytes([sound[700] ^ 1]) + sound[701:])
    command = ["merge", str(out), str(parts["city"]), str(field), "--jobs", "1"]
    assert main([*command, "--json"]) == 1
    told = capsys.readouterr()
    assert json.loads(told.out)["verified"] is False and json.loads(told.out)["findings"]
    assert f"{out} counts as unfinished: `scenegen repair` what it was made of" in told.err
    assert not (out / "dataset.json").exists() and not (out / "MANIFEST.sha256").exists()
    shard.unlink()
    shard.write_bytes(sound)
    assert main(command) == 0
    assert "verified" in capsys.readouterr().out and verify(out).ok
    assert main(command) == 0
    assert "it was there already" in capsys.readouterr().out


def test_a_whole_that_is_damaged_later_keeps_what_repair_needs(
    parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "all"
    command = ["merge", str(out), str(parts["city"]), str(parts["field"]), "--copy", "--jobs", "1"]
    assert main(command) == 0
    next(out.rglob("*.tar")).unlink()
    assert main(command) == 1
    assert f"`scenegen repair {out}` puts it right" in capsys.readouterr().err
    assert (out / "dataset.json").is_file() and (out / "MANIFEST.sha256").is_file()


@pytest.mark.parametrize("copy", [False, True])
def test_no_shard_is_fetched_through_a_link(parts: dict[str, Path], tmp_path: Path, copy: bool) -> None:
    """A part may say that its folder is one of somebody else's."""
    field = Path(shutil.copytree(parts["field"], tmp_path / "field"))
    (field / "shards" / "train").rename(tmp_path / "elsewhere")
    (field / "shards" / "train").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DatasetError, match="missing or not as long as its receipt says"):
        merge(tmp_path / "all", [parts["city"], field], copy=copy)
    assert {path.stat().st_nlink for path in (tmp_path / "elsewhere").rglob("*.tar")} == {1}


def test_copies_that_do_not_fit_are_refused_before_anything_is_copied(
    parts: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Links need no room; copies, and shards that get new names, do."""
    device = type("Usage", (), {"free": 1000, "total": 10**9})
    monkeypatch.setattr("scenegen_datasets.place.shutil.disk_usage", lambda _: device)
    roots = [parts["city"], parts["field"]]
    assert main(["merge", str(tmp_path / "copy"), *map(str, roots), "--copy"]) == 4
    assert not any((tmp_path / "copy").iterdir())
    merge(tmp_path / "linked", roots)
