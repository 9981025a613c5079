"""How other people's tools read what `scenegen export` writes: one reader per format, with the loss it may show.

Importable by tests and by ``benchmarks/exports.py``. Nothing here uses the exporter's own code.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from consumers import containers, kitti, pictures, scenes
from consumers.seen import EXACT, Original, Rule, Seen, compare
from scenegen_datasets.job import SPLITS

_KITTI = Rule(depth_step_m=1 / 256, depth_most_m=65535 / 256)


@dataclass(frozen=True)
class Consumer:
    """A reader, its rule, what of a frame it sees, and which pairs."""

    read: Callable[[Path], Iterator[Seen]]
    rule: Rule
    sees: tuple[str, ...]
    inner_only: bool = False


_GREY = ("depth_m", "grey")
_PLACE = ("pose", "K", "time_s")

CONSUMERS: dict[str, tuple[Consumer, ...]] = {
    "unpack": (Consumer(containers.unpack, Rule(), (*EXACT, *_PLACE)),),
    "kitti": (
        Consumer(
            kitti.kitti,
            Rule(depth_step_m=1 / 256, depth_most_m=65535 / 256, pose=1e-9, time_s=1e-5),
            (*_GREY, *_PLACE, "flow_px", "flow_seen_px"),
        ),
    ),
    "tartanair": (
        Consumer(
            pictures.tartanair,
            Rule(),
            ("depth", "semantic", "grey", "pose", "K", "flow_px", "flow_seen_px"),
        ),
    ),
    "pix2pix": (
        Consumer(
            pictures.pix2pix, Rule(depth_step_m=100 / 255, depth_most_m=100.0, depth_capped=True), _GREY
        ),
    ),
    "ms2": (Consumer(pictures.ms2, _KITTI, ("thermal", "depth_m", "pose", "K")),),
    "filelist": (
        Consumer(partial(pictures.filelist, kind="kitti"), _KITTI, _GREY),
        Consumer(
            partial(pictures.filelist, kind="vkitti2"), Rule(depth_step_m=0.01, depth_most_m=655.34), _GREY
        ),
        Consumer(partial(pictures.filelist, kind="zoe"), _KITTI, (*_GREY, "K")),
    ),
    "monodepth2": (Consumer(kitti.monodepth2, _KITTI, (*_GREY, "K"), inner_only=True),),
    "nerfstudio": (Consumer(scenes.nerfstudio, Rule(depth_share=1.2e-7), (*_GREY, *_PLACE)),),
    "colmap": (Consumer(scenes.colmap, Rule(), ("depth", "grey", "pose", "K")),),
    "tum": (
        Consumer(
            scenes.tum,
            Rule(depth_step_m=1 / 5000, depth_most_m=65535 / 5000, time_s=5e-7),
            (*_GREY, *_PLACE),
        ),
    ),
    "exr": (Consumer(containers.exr, Rule(), (*EXACT, *_PLACE)),),
    "hf": (Consumer(containers.hf, Rule(), ("thermal", "depth", "flow", "covisible", "semantic", *_PLACE)),),
    "zarr": (Consumer(containers.zarr, Rule(), (*EXACT, *_PLACE)),),
    "hdf5": (Consumer(containers.hdf5, Rule(), (*EXACT, *_PLACE)),),
    "rerun": (
        Consumer(
            containers.rerun,
            Rule(pose=1e-6, time_s=1e-6),
            ("thermal", "depth", "semantic", "temperature", *_PLACE),
        ),
    ),
}


def check(name: str, root: Path, dataset: Path, of: Collection[str] = SPLITS) -> tuple[int, dict[str, float]]:
    """Read an export back and compare every pair; returns how many frames were compared and the largest errors.

    Also asserts that a consumer saw of some frame everything that its format carries.

    Parameters
    ----------
    name : str
        Format.
    root, dataset : Path
        The export and what it was made from.
    of : collection of str
        Splits that were exported.
    """
    original = Original(dataset)
    compared, worst = 0, {}
    for consumer in CONSUMERS[name]:
        found: set[str] = set()
        open_keys = {key for key in original if original.pair_split(key) in of}
        if consumer.inner_only:
            open_keys = {key for key in open_keys if not original.is_last(key)}
        for seen in consumer.read(root):
            if seen.key.endswith("-0000"):
                continue  # frame 0 is no pair
            open_keys.remove(seen.key)
            errors = compare(seen, original.pair(seen.key), consumer.rule)
            worst |= {what: max(error, worst.get(what, 0.0)) for what, error in errors.items()}
            found |= errors.keys()
            compared += 1
        assert not open_keys, sorted(open_keys)[:3]
        assert found == original.sees(consumer.sees), (name, found)
    return compared, worst
