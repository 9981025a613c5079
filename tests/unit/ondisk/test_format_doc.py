"""The specification says what the code does: members, types, units, fields, one by one."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.index import ROW
from scenegen_datasets.job import SPLITS
from scenegen_datasets.layers import LAYERS, MAX_COUNT, MEMBERS
from scenegen_datasets.lock import VOLATILE_KEYS
from scenegen_datasets.receipt import SCHEMA
from scenegen_datasets.statistics import FRAME_STATISTICS

TEXT = (Path(__file__).parents[3] / "docs" / "dataset_format.md").read_text(encoding="utf-8")


def table(section: str) -> list[list[str]]:
    """Cells of the first table of a section."""
    body = TEXT.split(f"\n## {section}\n")[1].split("\n## ")[0]
    rows = [line for line in body.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]


def names(cells: list[str]) -> set[str]:
    return {name for cell in cells for name in re.findall(r"`([^`]+)`", cell)}


def test_members_layers_types_and_units() -> None:
    told = [tuple(row[:6]) for row in table("Members of a frame")]
    expected = [
        (
            f"`{x.member}`",
            f"`{x.name}`",
            " ".join(f"`{c}`" for c in x.channels if x.member[-4:] == ".exr"),
            x.stored,
            x.dtype,
            x.unit,
        )
        for x in LAYERS.values()
    ]
    assert told == [*expected, ("`json`", "", "", "", "", "")]
    assert list(dict.fromkeys(row[0].strip("`") for row in told)) == list(MEMBERS)


def test_index_fields() -> None:
    told = {row[0].strip("`"): row[1] for row in table("Index")}
    for name, (kind, *_) in ROW.fields.items():  # type: ignore[union-attr]
        base, shape = (kind.subdtype or (kind, ()))[:2]
        assert told.pop(name) == base.str.lstrip("<|") + (f" {shape}" if shape else "")
    assert told == {}
    assert set(FRAME_STATISTICS) <= set(ROW.names or ())
    assert f"version {SCHEMA}" in TEXT.splitlines()[2]


def test_what_is_written_is_what_is_told(pristine: Path) -> None:
    told = names([row[0] for row in table("dataset.json")])
    assert told == set(json.loads((pristine / "dataset.json").read_bytes()))
    receipt = json.loads((pristine / "receipts/train/city-00000/000.json").read_bytes())["receipt"]
    rows = {row[0].strip("`"): row[1] for row in table("Receipt")}
    assert set(rows) == set(receipt)
    for name in receipt["frames"][0]:
        assert f"`{name}`" in rows["frames"]
    for name in receipt["statistics"]:
        assert f"`{name}`" in rows["statistics"]
    line = json.loads((pristine / "clips.jsonl").read_text().splitlines()[0])
    clip = names([row[0] for row in table("Clip record")])
    assert clip == {f.name for f in fields(ClipRecord)}
    assert set(line) == clip | {"shard", "fingerprint", "content", "statistics"}
    assert names([table("Clip record")[0][1]]) == set(line["job"])


def test_files_and_names(pristine: Path) -> None:
    listing = TEXT.split("    DATASET/\n")[1].split("\n\n")[0]
    told = {line.split()[0].split("/")[0] for line in listing.splitlines()}
    there = {p.relative_to(pristine).parts[0] for p in pristine.rglob("*")}
    assert told - there == {"preview", "run.log.jsonl", ".lock", "releases.json"}
    assert there <= told
    for word in (*SPLITS, *VOLATILE_KEYS, str(MAX_COUNT), "city-00012-003-0041"):
        assert word in TEXT


def test_numpy_opens_the_index(pristine: Path) -> None:
    rows = np.load(pristine / "index.npy", mmap_mode="r")
    assert rows.dtype == ROW and len(rows) == 24


def test_the_examples_run(pristine: Path) -> None:
    examples = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    names: dict[str, Any] = {"path": str(pristine)}
    for example in examples:
        exec(compile(example, "docs/dataset_format.md", "exec"), names)
    assert len(examples) == 2
    assert names["sample"]["key"] == "city-00000-000-0001"
    np.testing.assert_array_equal(names["thermal"], names["sample"]["thermal"])
    np.testing.assert_array_equal(names["depth"], names["sample"]["depth"])
    assert names["clips"][0]["flow"].shape == (2, 12, 16, 2)
