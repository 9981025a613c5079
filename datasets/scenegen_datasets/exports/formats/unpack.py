"""Loose files: every member of every frame as it stands in the shard, byte for byte."""

from __future__ import annotations

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip."""
    job = clip.job
    home = f"{job.split}/{job.name}"
    for frame in range(job.frames):
        for suffix, data in clip.stored(frame):
            stage.put(f"{home}/{job.key(frame)}.{suffix}", data)
    stage.put(f"{home}/clip.json", pretty(dict(clip.facts)))
    return Written()


FORMAT = Format(
    name="unpack",
    readers="anything that opens PNG, TIFF and EXR files",
    layout="`SPLIT/CLIP/KEY.thermal.png`, `.depth.tiff`, `.flow.exr`, `.truth.exr`, `.json`; `clip.json`",
    range="that of the dataset",
    step="none",
    lost="nothing",
    sky="depth +inf",
    needs=(),
    bytes_per_pixel=20.0,
    write=write,
)
