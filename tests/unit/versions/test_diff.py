"""The rule of versions change by change, and the comparison of two datasets."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenegen.foundation.errors import InputError
from scenegen_cli.main import main
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.versions.diff import diff
from scenegen_datasets.versions.rule import compare, needed
from scenegen_datasets.versions.semver import Bump, Version
from scenegen_datasets.versions.state import ClipMark, State, state_of

NUMBERS = st.integers(0, 10**6)
VERSIONS = st.builds(Version, NUMBERS, NUMBERS, NUMBERS)


@given(VERSIONS, VERSIONS)
def test_versions_are_ordered_as_numbers_and_steps_are_what_they_say(one: Version, other: Version) -> None:
    assert Version.parse(str(one)) == one
    assert (one.step_to(other) is Bump.NONE) == (other <= one)
    for bump in (Bump.PATCH, Bump.MINOR, Bump.MAJOR):
        assert one < one.bumped(bump) and one.step_to(one.bumped(bump)) is bump
    assert one.bumped(Bump.NONE) == one


def test_ten_comes_after_nine() -> None:
    assert Version.parse("1.9.0") < Version.parse("1.10.0")


@pytest.mark.parametrize(
    "text", ["", "1", "1.0", "1.0.0.0", "1.0.00", "-1.0.0", "1.0.0 ", "1.0.٣", "9" * 12 + ".0.0"]
)
def test_what_is_no_version_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"MAJOR\.MINOR\.PATCH"):
        Version.parse(text)


@pytest.fixture(scope="module")
def pristine(fakes: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(fakes.make(tmp_path_factory.mktemp("pristine") / "dataset", 4))


@pytest.fixture(scope="module")
def state(pristine: Path) -> State:
    return state_of(pristine)


def edited(state: State, **clip: Any) -> State:
    """The state with another first clip."""
    name = min(state.clips)
    return replace(state, clips={**state.clips, name: replace(state.clips[name], **clip)})


def layer(state: State, name: str, value: Any) -> State:
    return replace(
        state,
        meaning={**state.meaning, "layers": {**state.meaning["layers"], name: value}},  # type: ignore[dict-item]
    )


def renamed(state: State, kind: str, names: dict[str, str]) -> State:
    return replace(state, names={**state.names, kind: {**state.names[kind], **names}})


CASES: dict[str, tuple[Callable[[State], State], Bump, str]] = {
    "nothing": (lambda s: s, Bump.NONE, ""),
    "pixels": (
        lambda s: edited(s, layers={**s.clips[min(s.clips)].layers, "depth": "0" * 32}),
        Bump.MAJOR,
        "1 clip has another depth: city-00000-000",
    ),
    "poses": (
        lambda s: edited(s, layers={**s.clips[min(s.clips)].layers, "json": "0" * 32}),
        Bump.MAJOR,
        "1 clip has other metadata of its frames: city-00000-000",
    ),
    "weather": (lambda s: edited(s, facts="0"), Bump.MAJOR, "1 clip has other facts: city-00000-000"),
    "split": (
        lambda s: edited(s, split="test"),
        Bump.MAJOR,
        "1 clip is in another split: city-00000-000 (train -> test)",
    ),
    "bytes": (
        lambda s: edited(s, shard="0"),
        Bump.PATCH,
        "1 clip holds the same samples in other bytes: city-00000-000",
    ),
    "fewer": (
        lambda s: replace(s, clips=dict(sorted(s.clips.items())[2:])),
        Bump.MAJOR,
        "2 clips are gone: city-00000-000, city-00000-001",
    ),
    "more": (
        lambda s: replace(s, clips={**s.clips, "zoo-00000-000": ClipMark("train", "", "", {})}),
        Bump.MINOR,
        "1 clip is new: zoo-00000-000",
    ),
    "layer": (lambda s: layer(s, "normal", ["float32", "1"]), Bump.MINOR, "layer normal is new"),
    "unit": (
        lambda s: layer(s, "depth", ["float32", "cm"]),
        Bump.MAJOR,
        "layer depth is of another type or unit",
    ),
    "band": (
        lambda s: replace(s, meaning={**s.meaning, "band_um": [7.5, 13.5]}),
        Bump.MAJOR,
        "what samples mean: band_um: [8.0,14.0] -> [7.5,13.5]",
    ),
    "class": (lambda s: renamed(s, "class", {"200": "kite"}), Bump.MINOR, "class 200 'kite' is new"),
    "renamed": (
        lambda s: renamed(s, "class", {"1": "street"}),
        Bump.MAJOR,
        "class 1 was 'road' and is 'street'",
    ),
    "recipe": (
        lambda s: replace(s, recipe={**s.recipe, "seed": 3}),
        Bump.PATCH,
        "the recipe has other values for seed",
    ),
    "schema": (
        lambda s: replace(s, storage={**s.storage, "schema_version": 2}),
        Bump.PATCH,
        "storage: schema_version: 1 -> 2",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_every_change_asks_for_its_bump_and_says_what_it_is(state: State, case: str) -> None:
    change, bump, words = CASES[case]
    found = compare(state, change(state))
    assert needed(found) is bump
    assert [str(one) for one in found] == ([words] if words else [])
    assert State.from_dict(json.loads(json.dumps(state.to_dict()))) == state


def test_the_largest_change_comes_first_and_decides(state: State) -> None:
    grown = replace(edited(state, shard="0", facts="0"), recipe={})
    bumps = [change.bump for change in compare(state, grown)]
    assert bumps == sorted(bumps, reverse=True) and bumps[0] is Bump.MAJOR


def test_layers_on_top_of_the_same_samples_are_a_minor_change(
    fakes: ModuleType, pristine: Path, tmp_path: Path
) -> None:
    more = fakes.make(tmp_path / "more", 4, layers=(*DEFAULT_LAYERS, "normal"))
    found = diff(pristine, more, pairs=0)
    assert (found.bump, found.proposed) == (Bump.MINOR, "1.1.0")
    assert [str(c) for c in found.changes] == ["layer normal is new"]
    back = diff(more, pristine, pairs=0)
    assert (back.bump, back.changes[0].what) == (Bump.MAJOR, "layer normal is gone")


def test_a_dataset_is_the_same_as_its_copy_and_older_than_its_growth(
    fakes: ModuleType, pristine: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    twin = shutil.copytree(pristine, tmp_path / "twin")
    assert main(["diff", str(pristine), str(twin)]) == 0
    assert "same: every sample and every byte of them" in capsys.readouterr().out
    fakes.make(twin, 6)
    assert main(["diff", str(pristine), str(twin)]) == 1
    said = capsys.readouterr().out
    assert "MINOR  2 clips are new: city-00002-000, city-00002-001" in said
    assert "as the next version after 1.0.0: 1.1.0 (MINOR)" in said


def test_machines_read_everything(
    fakes: ModuleType, pristine: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grown = fakes.make(shutil.copytree(pristine, tmp_path / "grown"), 6)
    assert main(["diff", str(pristine), str(grown), "--json", "--pairs", "9"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["same"], told["bump"], told["proposed"], told["recipe"]) == (False, "MINOR", "1.1.0", [])
    assert told["changes"] == [
        {"bump": "MINOR", "what": "2 clips are new", "clips": ["city-00002-000", "city-00002-001"]}
    ]
    assert (told["old"]["counts"]["clips"], told["new"]["counts"]["test_pairs"]) == (4, 6)
    for side in ("old", "new"):
        measures = told[side]["measures"]
        assert measures["pairs"] == 9
        assert sum(measures["classes"].values()) == pytest.approx(1.0)
        assert measures["classes"]["0"] == pytest.approx(0.25)  # a quarter of every picture is sky
        assert measures["depth_m"] == sorted(measures["depth_m"]) and measures["depth_m"][0] >= 2.0
        assert 260.0 <= measures["temperature_K"][0] < measures["temperature_K"][-1] <= 320.0


def test_what_cannot_be_compared_is_said_in_one_line(
    fakes: ModuleType, pristine: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged = shutil.copytree(pristine, tmp_path / "damaged")
    receipt = damaged / fakes.jobs(1)[0].receipt
    receipt.write_bytes(receipt.read_bytes()[:-5])
    short = shutil.copytree(pristine, tmp_path / "short")
    (short / fakes.jobs(1)[0].receipt).unlink()
    growing = fakes.make(tmp_path / "growing", 2, done=False)
    cases = [
        ([str(tmp_path / "nowhere")], "no dataset at"),
        ([str(growing)], "is not finished"),
        ([str(damaged)], "damaged"),
        ([str(short)], "3 receipts, dataset.json counts 4 clips"),
        ([str(pristine), "--pairs", "-1"], "look at 0 to"),
        ([], "diff --help"),
    ]
    for arguments, message in cases:
        assert main(["diff", str(pristine), *arguments]) == 2
        said = capsys.readouterr().err.strip()
        assert message in said and "\n" not in said
