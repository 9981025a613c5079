"""Several datasets as one: the same whole in any order, nothing shared by accident, no half of it that looks whole."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.info import info
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.splits.held_out import WEATHERS
from scenegen_datasets.splits.knobs import SplitKnobs
from scenegen_datasets.store import create_or_open, read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.versions import placing as module
from scenegen_datasets.versions.merge import merge
from scenegen_datasets.versions.numbers import origin_of
from scenegen_datasets.versions.release import release


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
    assert origin_of(lock, job).entry["recipe"] == read_lock(parts["field"])["recipe"]
    plain = read_lock(parts["city"])
    assert origin_of(plain, fakes.jobs(1)[0]).entry is plain
    with pytest.raises(DatasetError, match="no part"):
        origin_of(lock, replace(job, world=9))
    assert (
        lock["recipe"]["map"] == ["city", "field"] and lock["recipe"]["sensor"] == plain["recipe"]["sensor"]
    )
    assert "seed" not in lock["recipe"]


def test_a_merged_dataset_is_released_and_merged_again_but_not_grown(
    fakes: ModuleType, parts: dict[str, Path], tmp_path: Path
) -> None:
    out = whole(parts, tmp_path / "all", "city", "field")
    release(out, "1.0.0")
    assert verify(out).ok
    with pytest.raises(InputError, match="merged from other datasets and does not grow"):
        create_or_open(out, "x", fakes.lock(99))


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


def test_the_page_says_what_there_is(
    parts: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its example runs, and its keys and kinds of weather are those of the code."""
    text = (Path(__file__).parents[3] / "docs" / "versions.md").read_text(encoding="utf-8")
    first = shutil.copytree(parts["city"], tmp_path / "first")
    names = {"first": str(first), "second": str(parts["field"]), "out": str(tmp_path / "out")}
    (example,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    exec(compile(example, "docs/versions.md", "exec"), dict(names))
    assert capsys.readouterr().out == "1.1.0\n"
    keys = {key.replace("_", "-") for key in SplitKnobs.model_fields}
    assert set(re.findall(r"`--splits\.([a-z-]+)", text)) == keys
    row = next(line for line in text.splitlines() if "--splits.test-weather" in line)
    assert set(re.findall(r"`([a-z]+)`", row)) == set(WEATHERS)
