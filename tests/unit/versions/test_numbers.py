"""Two seeds of one map in one dataset: each world has a name of its own, in the split it was made for."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_cli.main import main
from scenegen_datasets.info import info
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.plan import split_of
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.store import read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.versions.diff import diff
from scenegen_datasets.versions.merge import merge
from scenegen_datasets.versions.numbers import BLOCK, offset_of, offsets, origin_of

SEEDS = st.integers(0, 2**63 - 1) | st.integers(0, 300)
WORLDS = st.sets(
    st.tuples(SEEDS, st.sampled_from(["city", "field"]), st.integers(0, 2500)), min_size=1, max_size=40
)


@settings(deadline=None, max_examples=50)
@given(WORLDS)
def test_every_world_gets_a_name_of_its_own_in_its_split(worlds: set[tuple[int, str, int]]) -> None:
    added = offsets(worlds)
    names = {(map, number + added[seed]) for seed, map, number in worlds}
    assert len(names) == len(worlds)
    assert all(split_of(number + added[seed]) == split_of(number) for seed, _, number in worlds)
    assert added == offsets(sorted(worlds)) == offsets(sorted(worlds, reverse=True))


@pytest.mark.parametrize(
    ("worlds", "added"),
    [
        ({(3, "city", 0), (4, "field", 0)}, {3: 0, 4: 0}),
        ({(0, "city", 0), (7, "city", 0), (7, "city", 12)}, {0: 0, 7: 7000}),
        ({(0, "city", 4), (107, "city", 4), (7, "city", 4)}, {0: 0, 7: 7000, 107: 8000}),
        ({(0, "city", 0), (0, "city", 1999), (1, "city", 0), (1, "city", 998)}, {0: 0, 1: 1000}),
        ({(99, "city", 1001), (5, "city", 1001)}, {5: 5000, 99: 0}),
    ],
    ids=["other maps", "a thousand each", "two of one thousand", "gaps are filled", "over the end"],
)
def test_a_seed_is_read_off_the_number(worlds: set[tuple[int, str, int]], added: dict[int, int]) -> None:
    assert offsets(worlds) == added


def test_more_worlds_than_numbers_are_refused() -> None:
    worlds = [(seed, "city", number) for seed in range(3) for number in (0, 45_000, 99_999)]
    with pytest.raises(InputError, match="100,000 numbers are not enough"):
        offsets(worlds)


@pytest.fixture(scope="module")
def seeds(make_map: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Three worlds of one map each, by three seeds, and one more map."""
    base = tmp_path_factory.mktemp("seeds")
    return {seed: make_map(base / f"s{seed}", "city", 6, seed=seed) for seed in (0, 1, 7)}


def test_two_seeds_of_a_map_are_one_dataset(
    fakes: ModuleType,
    seeds: dict[int, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = {seed: fakes.tree(root) for seed, root in seeds.items()}
    out = tmp_path / "all"
    assert main(["merge", str(out), str(seeds[7]), str(seeds[0]), "--jobs", "1"]) == 0
    assert "worlds of seed 7 are numbered from 7000 on" in capsys.readouterr().out
    assert verify(out).findings == () and {seed: fakes.tree(root) for seed, root in seeds.items()} == before
    facts = info(out)
    assert (facts.clips, facts.worlds, facts.splits) == (12, 6, {"train": 12, "val": 12, "test": 12})
    lock = read_lock(out)
    assert sorted(offset_of(part) for part in lock["parts"]) == [0, 7000]
    told = json.loads((out / "dataset.json").read_text())["parts"]
    assert [part["worlds"] for part in told] == [part["worlds"] for part in lock["parts"]]
    found = {sample["key"]: sample for sample in PairDataset(out, layers=("thermal", "depth"))}
    assert len(found) == 36
    for sample in PairDataset(seeds[7], layers=("thermal", "depth")):
        other = found[sample["key"].replace("city-00", "city-07")]
        assert sample["split"] == other["split"] and sample["facts"] == other["facts"]
        np.testing.assert_array_equal(sample["thermal"], other["thermal"])


def test_a_shard_under_another_name_is_the_same_but_for_its_keys(
    seeds: dict[int, Path], tmp_path: Path
) -> None:
    import tarfile

    out = tmp_path / "all"
    merged = merge(out, [seeds[0], seeds[7]])
    assert (merged.linked, merged.copied, merged.offsets) == (6, 6, {7: 7000})
    for path in receipt_paths(seeds[7]):
        moved = path.replace("city-00", "city-07")
        old, new = read_receipt(seeds[7], path), read_receipt(out, moved)
        assert old.size == new.size and old.sha256 != new.sha256 and old.statistics == new.statistics
        assert origin_of(read_lock(out), new.clip.job).world == old.clip.job.world
        with tarfile.open(seeds[7] / shard_of(path)) as a, tarfile.open(out / shard_of(moved)) as b:
            names = a.getnames()
            assert b.getnames() == [name.replace("city-00", "city-07") for name in names]
            for name, other in zip(names, b.getnames(), strict=True):
                one, two = (tar.extractfile(n).read() for tar, n in ((a, name), (b, other)))  # type: ignore[union-attr]
                assert one == two.replace(b"city-07", b"city-00") and (one == two) != name.endswith(".json")


def test_order_and_steps_of_merging_seeds_do_not_matter(
    fakes: ModuleType, seeds: dict[int, Path], make_map: Callable[..., Path], tmp_path: Path
) -> None:
    """Also where a later part makes numbers clash that did not before."""
    field = make_map(tmp_path / "field", "field", 2, seed=9)
    other = make_map(tmp_path / "other", "field", 2, seed=1)
    everything = [seeds[0], seeds[7], field, other]
    one = merge(tmp_path / "1" / "all", everything).info
    for k, order in enumerate(list(itertools.permutations(everything))[5:24:13]):
        merge(tmp_path / f"in{k}", order[:2])
        merge(tmp_path / f"on{k}", [tmp_path / f"in{k}", order[2]])
        last = tmp_path / f"out{k}" / "all"
        assert merge(last, [order[3], tmp_path / f"on{k}"]).info.content_id == one.content_id
        assert read_lock(last) == read_lock(tmp_path / "1" / "all") and verify(last).ok


def test_names_stay_when_a_seed_joins(seeds: dict[int, Path], tmp_path: Path) -> None:
    merge(tmp_path / "two", [seeds[1], seeds[7]])
    merge(tmp_path / "three", [seeds[0], seeds[1], seeds[7]])
    found = diff(tmp_path / "two", tmp_path / "three", pairs=0)
    assert [change.what for change in found.changes if change.bump.name != "PATCH"] == ["6 clips are new"]
    assert found.proposed == "1.1.0"


@pytest.mark.parametrize("offset", [-BLOCK, 7, True, "1000", 10**9])
def test_a_lock_with_an_offset_that_makes_no_sense_is_refused(offset: Any) -> None:
    with pytest.raises(DatasetError, match="world_offset of a part makes no sense"):
        offset_of({"recipe": {}, "world_offset": offset})
