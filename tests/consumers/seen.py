"""What a consumer of an export sees of one frame, and how near that must be to the dataset."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from scenegen_datasets import PairDataset
from scenegen_datasets.index import job_of
from scenegen_datasets.scale import scale_of
from scenegen_datasets.source import open_source
from scenegen_render.sensor.scale import counts_to_brightness_K

EXACT = (
    "thermal",
    "depth",
    "flow",
    "covisible",
    "radiance",
    "temperature",
    "semantic",
    "instance",
    "material",
)


@dataclass(frozen=True)
class Seen:
    """One frame as a consumer decodes it, turned back to our conventions.

    ``exact`` holds arrays that must equal the dataset's. ``depth_m`` and ``flow_px`` are NaN where the format says
    that there is no value; ``grey`` are 8-bit pictures with the gain that explains them.
    """

    key: str
    exact: Mapping[str, np.ndarray] = field(default_factory=dict)
    depth_m: np.ndarray | None = None
    flow_px: np.ndarray | None = None
    flow_seen_px: np.ndarray | None = None
    grey: np.ndarray | None = None
    gain: Mapping[str, Any] | None = None
    pose: np.ndarray | None = None
    pose_from_first: np.ndarray | None = None
    K: np.ndarray | None = None
    time_s: float | None = None


@dataclass(frozen=True)
class Rule:
    """The documented range and loss of a format."""

    depth_step_m: float = 0.0
    depth_share: float = 0.0
    depth_most_m: float = np.inf
    depth_capped: bool = False
    pose: float = 1e-9
    time_s: float = 0.0


class Original:
    """The dataset that was exported, pair by pair, with every layer."""

    def __init__(self, dataset: Path) -> None:
        self._source = open_source(dataset, False)
        layers = [name for name in EXACT if name in self._source.layers]
        self._pairs = PairDataset(dataset, layers=layers)
        self._positions: dict[str, tuple[int, int]] = {}
        for clip, start in enumerate(self._source.starts):
            job = job_of(self._source.rows[int(start)])
            for frame in range(1, job.frames):
                self._positions[job.key(frame)] = (len(self._positions), clip)

    def sees(self, names: Collection[str]) -> set[str]:
        """What can be compared, of `names`: not layers that are not stored, nor what is made of them."""
        made_of = {"flow_px": {"flow"}, "flow_seen_px": {"flow", "covisible"}, **{x: {x} for x in EXACT}}
        return {name for name in names if made_of.get(name, set()) <= set(self._source.layers)}

    def __iter__(self) -> Iterator[str]:
        return iter(self._positions)

    def pair(self, key: str) -> dict[str, Any]:
        """Everything about one pair, and the pose of the first frame of its clip."""
        position, clip = self._positions[key]
        sample = self._pairs[position]
        kelvin = counts_to_brightness_K(sample["thermal"], scale_of(self._source.facts(clip)))
        first = self._source.rows[int(self._source.starts[clip])]
        return {**sample, "brightness_K": kelvin.astype(np.float64), "first": first["world_from_camera"]}

    def pair_split(self, key: str) -> str:
        """Split of a pair."""
        start = int(self._source.starts[self._positions[key][1]])
        return job_of(self._source.rows[start]).split

    def is_last(self, key: str) -> bool:
        """Whether it is the last of its clip."""
        start = self._source.starts[self._positions[key][1]]
        return int(key[-4:]) + 1 == int(self._source.rows[int(start)]["frames"])


def compare(seen: Seen, sample: Mapping[str, Any], rule: Rule) -> dict[str, float]:
    """Assert that a frame is what was exported, within the rule; returns the largest errors."""
    errors: dict[str, float] = {}
    for name, array in seen.exact.items():
        assert array.dtype == sample[name].dtype, (name, array.dtype)
        assert np.array_equal(array, sample[name], equal_nan=array.dtype.kind == "f"), (seen.key, name)
        errors[name] = 0.0
    if seen.depth_m is not None:
        errors["depth_m"] = _depth(seen.depth_m, sample["depth"].astype(np.float64), rule)
    if seen.flow_px is not None:
        errors["flow_px"] = _flow(seen.flow_px, sample["flow"].astype(np.float64), True)
    if seen.flow_seen_px is not None and "covisible" in sample:
        errors["flow_seen_px"] = _flow(
            seen.flow_seen_px, sample["flow"].astype(np.float64), sample["covisible"]
        )
    if seen.grey is not None:
        errors["grey"] = _grey(seen.grey, seen.gain, sample)
    pose = sample["world_from_camera"]
    for name, found, wanted in (
        ("pose", seen.pose, pose),
        ("pose", seen.pose_from_first, np.linalg.inv(sample["first"]) @ pose),
        ("K", seen.K, sample["K"]),
    ):
        if found is not None:
            errors[name] = float(np.abs(found - wanted).max())
            assert errors[name] <= rule.pose * (1.0 + np.abs(wanted).max()), (seen.key, name, found, wanted)
    if seen.time_s is not None:
        errors["time_s"] = abs(seen.time_s - sample["time_s"])
        assert errors["time_s"] <= rule.time_s + 1e-12, (seen.key, seen.time_s, sample["time_s"])
    return errors


def _depth(found: np.ndarray, wanted: np.ndarray, rule: Rule) -> float:
    """Half a step where it fits, nothing where it does not."""
    assert found.shape == wanted.shape
    if rule.depth_capped:
        wanted, there = np.minimum(wanted, rule.depth_most_m), np.ones(wanted.shape, bool)
    else:
        there = np.isfinite(wanted) & (wanted < rule.depth_most_m + rule.depth_step_m / 2)
        there &= wanted > rule.depth_step_m / 2
    assert np.array_equal(np.isfinite(found), there)
    error = np.abs(found - wanted)[there]
    assert (error <= rule.depth_step_m / 2 + (rule.depth_share + 1e-12) * wanted[there]).all(), error.max()
    return float(error.max(initial=0.0))


def _flow(found: np.ndarray, wanted: np.ndarray, kept: Any) -> float:
    """1/128 px where it fits 16 bits, nothing elsewhere."""
    with np.errstate(invalid="ignore"):
        fits = ((wanted >= -512.0 - 1 / 128) & (wanted < 511.984375 + 1 / 128)).all(axis=2)
    there = np.broadcast_to(kept & fits, fits.shape)
    assert np.array_equal(np.isfinite(found).all(axis=2), there)
    error = np.abs(found - wanted)[there]
    assert (error <= 1 / 128).all()
    return float(error.max(initial=0.0))


def _grey(grey: np.ndarray, gain: Mapping[str, Any] | None, sample: Mapping[str, Any]) -> float:
    """Half a grey level between black and white, the ends beyond; in grey levels."""
    assert gain is not None and grey.dtype == np.uint8
    value = sample["thermal"].astype(np.float64) if gain["unit"] == "count" else sample["brightness_K"]
    position = (value - gain["black"]) / (gain["white"] - gain["black"]) * 255.0
    error = np.abs(grey - np.clip(position, 0.0, 255.0))
    assert (error <= 0.5 + 1e-6).all()
    return float(error.max())
