"""What describes a dataset to people and catalogues agrees with what is in it."""

from __future__ import annotations

import fnmatch
import json
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

from scenegen.classes import CLASSES
from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError
from scenegen.materials.table import materials
from scenegen_datasets.description import read_description
from scenegen_datasets.finish import finish
from scenegen_datasets.info import info
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.licence import licence_of
from scenegen_datasets.manifest import file_sha256, read_manifest
from scenegen_datasets.seal import with_seal


def header(root: Path) -> dict[str, Any]:
    text = (root / "README.md").read_text(encoding="utf-8")
    assert text.startswith("---\n")
    return dict(yaml.safe_load(text.split("---\n")[1]))


def test_the_card_names_every_shard_once_and_nothing_else(pristine: Path) -> None:
    (config,) = header(pristine)["configs"]
    files = [str(p.relative_to(pristine)) for p in pristine.rglob("*") if p.is_file()]
    matched = [f for entry in config["data_files"] for f in files if fnmatch.fnmatch(f, entry["path"])]
    assert sorted(matched) == sorted(f for f in files if f.endswith(".tar"))
    assert [entry["split"] for entry in config["data_files"]] == ["train", "validation", "test"]
    assert header(pristine)["size_categories"] == ["n<1K"]


def test_a_split_without_clips_is_not_promised(fakes: ModuleType, tmp_path: Path) -> None:
    (config,) = header(fakes.make(tmp_path / "d", 2))["configs"]
    assert [entry["split"] for entry in config["data_files"]] == ["train"]


def test_the_card_tells_sizes_and_layers(pristine: Path) -> None:
    text = (pristine / "README.md").read_text(encoding="utf-8")
    assert "18 pairs" in text and "16x12" in text and "3 procedural worlds (city)" in text
    for layer in DEFAULT_LAYERS:
        assert f"| `{layer}` |" in text
    assert "| hour | 0 | 22 |" in text


def references(node: Any) -> Iterator[str]:
    """All ``{"@id": x}`` that only refer."""
    if isinstance(node, dict):
        if set(node) == {"@id"}:
            yield node["@id"]
        for child in node.values():
            yield from references(child)
    elif isinstance(node, list):
        for child in node:
            yield from references(child)


def test_croissant_refers_to_what_it_defines(pristine: Path) -> None:
    told = json.loads((pristine / "croissant.json").read_bytes())
    assert told["@type"] == "sc:Dataset" and told["conformsTo"] == "http://mlcommons.org/croissant/1.0"
    sets = told["recordSet"]
    defined = {x["@id"] for x in [*told["distribution"], *sets, *(f for s in sets for f in s["field"])]}
    assert len(defined) == len(told["distribution"]) + len(sets) + 2 * len(sets)
    assert set(references({k: v for k, v in told.items() if k != "@context"})) <= defined
    shards = {x["contentUrl"]: x["sha256"] for x in told["distribution"] if x["@type"] == "cr:FileObject"}
    assert len(shards) == 6
    for path, sha256 in shards.items():
        assert file_sha256(pristine / path) == sha256


def test_croissant_finds_keys_in_member_names(pristine: Path) -> None:
    told = json.loads((pristine / "croissant.json").read_bytes())
    patterns = [s["field"][0]["source"]["transform"]["regex"] for s in told["recordSet"]]
    names = [
        f"city-00000-000-0003.{m}" for m in ("thermal.png", "depth.tiff", "flow.exr", "truth.exr", "json")
    ]
    assert [m[1] for p, n in zip(patterns, names, strict=True) if (m := re.match(p, n))] == [
        "city-00000-000-0003"
    ] * 5


def test_the_description_carries_the_lists_that_ids_refer_to(pristine: Path) -> None:
    told = json.loads((pristine / "dataset.json").read_bytes())
    assert [(c["id"], c["name"]) for c in told["classes"]] == [(int(c.id), c.name) for c in CLASSES]
    assert {(m["id"], m["name"]) for m in told["materials"]} == {(m.id, m.name) for m in materials().values()}
    assert told["sensor"] == {"low_radiance": 11.2, "high_radiance": 160.5, "counts": 16383}
    assert told["grid"] == {"height_px": 12, "width_px": 16}


def test_clips_that_disagree_cannot_be_one_dataset(fakes: ModuleType, tmp_path: Path) -> None:
    from dataclasses import replace

    from scenegen_datasets.commit import commit_clip

    root = fakes.make(tmp_path / "d", 1, done=False)
    first, second = fakes.jobs(2)
    record = replace(
        fakes.record(second), sensor={"low_radiance": 0.0, "high_radiance": 1.0, "counts": 16383}
    )
    commit_clip(root, record, fakes.encoded(second), fingerprint="f")
    with pytest.raises(DatasetError, match="disagree on their sensor"):
        finish(root, [first, second])


def test_the_manifest_holds_every_file_but_itself(pristine: Path) -> None:
    files = {str(p.relative_to(pristine)) for p in pristine.rglob("*") if p.is_file()}
    assert set(read_manifest(pristine / "MANIFEST.sha256")) == files - {"MANIFEST.sha256"}


def test_the_summary_of_a_finished_dataset(pristine: Path) -> None:
    told = info(pristine)
    assert (told.pairs, told.frames, told.clips, told.worlds, told.pairs_planned) == (18, 24, 6, 3, 18)
    assert told.complete and told.missing == ()
    assert told.splits == {"train": 6, "val": 6, "test": 6}
    assert told.ranges["hour"] == (0.0, 22.0) and told.ranges["weather.air_mean_K"] == (290.0, 295.0)
    assert told.bytes == sum(p.stat().st_size for p in pristine.rglob("*.tar"))


@pytest.mark.parametrize("name", ["x\nconfigs: []", "<img src=x>", "", 7, None, "CC-BY 4.0"])
def test_a_licence_that_is_none_reaches_no_card(name: object) -> None:
    """The header of the card is YAML: a line end in a name would begin another key."""
    with pytest.raises(DatasetError, match="not the name of a licence"):
        licence_of({"license": name})
    assert licence_of({"license": "ODbL-1.0"}) == "ODbL-1.0" and licence_of({}) == "CC-BY-4.0"


@pytest.mark.parametrize("place", [("name",), ("ranges", "hour"), ("maps", 0)])
def test_markup_in_a_name_is_refused_before_it_reaches_a_card(dataset: Path, place: tuple[Any, ...]) -> None:
    path = dataset / "dataset.json"
    body = json.loads(path.read_bytes())
    body.pop("seal")
    *above, last = place
    owner = body
    for key in above:
        owner = owner[key]
    owner["<img src=x onerror=alert(1)>" if last == "hour" else last] = (
        [0, 1] if last == "hour" else "<img src=x onerror=alert(1)>"
    )
    path.write_bytes(pretty(with_seal(body)))
    with pytest.raises(DatasetError, match="makes no sense"):
        read_description(path)
