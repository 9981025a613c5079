"""What of a dataset a version number speaks about, small enough to be kept with every release."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.description import read_description
from scenegen_datasets.lock import stable
from scenegen_datasets.receipt import Receipt, read_receipt, receipt_paths
from scenegen_datasets.store import DATASET, read_lock

_DIGITS = 32
"""Hexadecimal digits of a digest that are kept: 128 bits, for they tell accidents apart, not forgeries."""

_MARK = ("split", "facts", "shard", "layers")

Plain = dict[str, Any]


@dataclass(frozen=True)
class ClipMark:
    """What one clip holds, as digests.

    Attributes
    ----------
    split : str
    facts : str
        Of the clip record (hour, weather, camera, ...) without its place in the plan.
    shard : str
        Of the stored bytes.
    layers : mapping of str to str
        Of each decoded layer over all frames; ``json`` is that of the frames' metadata.
    """

    split: str
    facts: str
    shard: str
    layers: Mapping[str, str]

    @classmethod
    def of(cls, receipt: Receipt) -> ClipMark:
        """Read off a receipt."""
        facts = receipt.clip.to_dict()
        facts["job"] = {k: v for k, v in facts["job"].items() if k not in ("ordinal", "split")}
        sums: dict[str, Any] = {}
        for frame in receipt.frames:
            for layer, digest in frame.digests.items():
                sums.setdefault(layer, hashlib.sha256()).update(digest.encode())
        return cls(
            split=receipt.clip.job.split,
            facts=canonical.digest(facts)[:_DIGITS],
            shard=receipt.sha256[:_DIGITS],
            layers={layer: sums[layer].hexdigest()[:_DIGITS] for layer in sorted(sums)},
        )


@dataclass(frozen=True)
class State:
    """A dataset at one moment, as far as versions go.

    Attributes
    ----------
    recipe_id : str
    scene_semantics : int
    recipe : mapping
        The resolved recipe without what decides no sample.
    meaning : mapping
        What numbers in the layers stand for: conventions, grid, band, scale of the camera, unit and type of each layer.
    names : mapping
        Class and material names by id.
    storage : mapping
        How layers are stored, and the schema version.
    clips : mapping of str to ClipMark
        By name.
    """

    recipe_id: str
    scene_semantics: int
    recipe: Mapping[str, Any]
    meaning: Mapping[str, Any]
    names: Mapping[str, Mapping[str, str]]
    storage: Mapping[str, Any]
    clips: Mapping[str, ClipMark]

    @classmethod
    def of(
        cls, lock: Mapping[str, Any], description: Mapping[str, Any], clips: Mapping[str, ClipMark]
    ) -> State:
        """Compose it from a dataset's lock, the content of its ``dataset.json``, and its clips."""
        return cls(
            recipe_id=lock["recipe_id"],
            scene_semantics=int(lock.get("scene_semantics") or 0),
            recipe=stable(lock["recipe"]),
            meaning=meaning_of(description),
            names=names_of(description),
            storage={
                "schema_version": description["schema_version"],
                "layers": {x["name"]: [x["member"], x["stored"]] for x in description["layers"]},
            },
            clips=dict(clips),
        )

    def to_dict(self) -> Plain:
        """Return plain data; `from_dict` reads it back exactly."""
        clips = {name: asdict(clip) for name, clip in self.clips.items()}
        return {
            "recipe_id": self.recipe_id,
            "scene_semantics": self.scene_semantics,
            "recipe": dict(self.recipe),
            "meaning": dict(self.meaning),
            "names": {kind: dict(names) for kind, names in self.names.items()},
            "storage": dict(self.storage),
            "clips": clips,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> State:
        """Read what `to_dict` returned, and `scenegen_datasets.documents.HISTORY` found in shape."""
        clips = {name: ClipMark(**{k: clip[k] for k in _MARK}) for name, clip in data["clips"].items()}
        names = ("recipe_id", "scene_semantics", "recipe", "meaning", "names", "storage")
        return cls(**{name: data[name] for name in names}, clips=clips)


def meaning_of(description: Mapping[str, Any]) -> Plain:
    """What numbers in the layers stand for: two datasets that differ here cannot be read by the same code."""
    return {
        "conventions": description["conventions"],
        "grid": description["grid"],
        "band_um": description["band_um"],
        "sensor": description["sensor"],
        "layers": {x["name"]: [x["dtype"], x["unit"], *x["channels"]] for x in description["layers"]},
    }


def names_of(description: Mapping[str, Any]) -> dict[str, dict[str, str]]:
    """Names of classes and materials by id, as text."""
    return {
        kind: {str(entry["id"]): entry["name"] for entry in description[field]}
        for kind, field in (("class", "classes"), ("material", "materials"))
    }


def state_of(root: Path) -> State:
    """Read the state of a finished dataset from its receipts.

    Raises
    ------
    InputError
        If there is no dataset at `root`, or it is not finished.
    DatasetError
        If what describes it is damaged, or counts other clips than there are receipts.
    """
    lock = read_lock(root)
    description = finished_description(root)
    marks = {}
    for path in receipt_paths(root):
        receipt = read_receipt(root, path)
        marks[receipt.clip.job.name] = ClipMark.of(receipt)
    if len(marks) != description["counts"]["clips"]:
        raise DatasetError(
            f"{root}: {len(marks)} receipts, {DATASET} counts {description['counts']['clips']} clips; "
            "run 'scenegen verify'"
        )
    return State.of(lock, description, marks)


def finished_description(root: Path) -> Plain:
    """Read ``dataset.json`` of a finished dataset.

    Raises
    ------
    InputError
        If there is no dataset at `root`, or it is not finished.
    DatasetError
        If it is damaged.
    """
    read_lock(root)
    if not (root / DATASET).exists():
        raise InputError(f"{root} is not finished; finish it with the command that began it")
    return read_description(root / DATASET)
