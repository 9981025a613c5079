"""What catalogues and lawyers read: the datasheet, the licence, and Croissant as its own library understands it."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import yaml

from scenegen.foundation.errors import InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.finish import finish
from scenegen_datasets.licence import checked_licence, hub_lines, licence_url
from scenegen_datasets.lock import make_lock
from scenegen_datasets.store import create_or_open


def header(root: Path) -> dict[str, Any]:
    return dict(yaml.safe_load((root / "README.md").read_text(encoding="utf-8").split("---\n")[1]))


def test_the_licence_is_stated_everywhere(pristine: Path) -> None:
    assert json.loads((pristine / "dataset.json").read_bytes())["license"] == "CC-BY-4.0"
    assert header(pristine)["license"] == "cc-by-4.0"
    assert json.loads((pristine / "croissant.json").read_bytes())["license"] == licence_url("CC-BY-4.0")
    assert "[CC-BY-4.0](https://spdx.org/licenses/CC-BY-4.0.html)" in (pristine / "README.md").read_text()


def test_another_licence_is_kept_when_the_dataset_grows(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "d", 2)
    plain = fakes.lock(6)
    free = make_lock(
        plain["recipe"], name="city-16", scene_semantics=1, render=fakes.RENDER, license="CC0-1.0"
    )
    assert free["recipe_id"] == plain["recipe_id"], "a licence makes no other samples"
    create_or_open(root, "x", free)
    assert not (root / "dataset.json").exists(), "it is another dataset until it is finished again"
    finish(root, fakes.jobs(2))
    assert header(root)["license"] == "cc0-1.0"
    fakes.make(root, 4)
    assert json.loads((root / "dataset.json").read_bytes())["license"] == "CC0-1.0"


def test_licences_are_spdx_names() -> None:
    assert hub_lines("ODC-By") == ["license: odc-by"]
    assert hub_lines("LicenseRef-ours") == ["license: other", "license_name: licenseref-ours"]
    for bad in ("", "all rights reserved", "a\nb", "../x", "x" * 65):
        with pytest.raises(InputError, match="SPDX"):
            checked_licence(bad)


def test_the_card_is_a_datasheet(pristine: Path) -> None:
    text = (pristine / "README.md").read_text(encoding="utf-8")
    sections = [line[3:] for line in text.splitlines() if line.startswith("## ")]
    assert sections == [
        "Why it exists",
        "What is in it",
        "How it was made",
        "What it is for",
        "Limits",
        "Licence",
    ]
    assert max(map(len, text.splitlines())) < 240


@pytest.mark.filterwarnings("ignore")
def test_croissant_is_valid_and_its_records_are_the_members(pristine: Path) -> None:
    mlcroissant = pytest.importorskip("mlcroissant")
    told = mlcroissant.Dataset(str(pristine / "croissant.json"))
    issues = told.metadata.issues
    assert not issues.errors
    assert all("datePublished" in warning for warning in issues.warnings), (
        "a date would differ from run to run"
    )
    samples = {sample["key"]: sample for sample in PairDataset(pristine)}
    for record_set, layer in (("thermal", "thermal"), ("depth", "depth")):
        found = {
            r[f"{record_set}/key"].decode(): r[f"{record_set}/content"] for r in told.records(record_set)
        }
        assert len(found) == 24
        for key, sample in samples.items():
            np.testing.assert_array_equal(np.asarray(found[key]), sample[layer])
    keys = {json.loads(r["json/content"])["key"] for r in told.records("json")}
    assert keys == set(found)
