"""Pix2Pix: aligned pictures, thermal on the left (A), depth on the right (B), as ``dataset_mode aligned`` reads them.

Depth is linear to a cap, which is white, as in AirSim's DepthVis; the sky is as far as anything can be.
"""

from __future__ import annotations

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import add
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png
from scenegen_datasets.exports.stage import Stage

CAPPED = "depth_capped"


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write the pairs of one clip."""
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    for picture in clip.pictures("thermal", "depth", pairs_only=True):
        depth = picture["depth"].astype(np.float64)
        white = np.minimum(depth / options.depth_cap_m, 1.0) * 255.0
        sides = (gain.grey(picture["thermal"]), np.rint(white).astype(np.uint8))
        stage.put(f"{clip.job.split}/{picture.key}.png", colour_png(np.hstack(sides)))
        capped = int((np.isfinite(depth) & (depth > options.depth_cap_m)).sum())
        add(counts, {CLIPPED: gain.clipped(picture["thermal"]), CAPPED: capped})
    stage.put(f"gain/{clip.job.name}.json", pretty(dict(gain.facts)))
    return Written(counts)


FORMAT = Format(
    name="pix2pix",
    readers="pytorch-CycleGAN-and-pix2pix (`--dataset_mode aligned`) and its kin",
    layout="`SPLIT/KEY.png`, A thermal, B depth, side by side; `gain/CLIP.json`",
    range="depth to the cap (`--depth-cap-m`, 100 m)",
    step="depth 1/255 of the cap (0.39 m); thermal 8 bits",
    lost="depth beyond the cap, thermal beyond the gain; everything else; frame 0 of each clip, which is no pair",
    sky="white, as the cap",
    needs=("thermal", "depth"),
    bytes_per_pixel=2.0,
    pairs_only=True,
    write=write,
    heeds=CHOICES | {"depth_cap_m"},
    invalid={
        **CLIPPING,
        CAPPED: "pixels with a surface beyond the cap became white",
    },
)
