"""What the frames of datasets look like in numbers, beside real aerial long-wave frames.

For each dataset: the distribution of depth, the classes that appear, and of its thermal frames (in kelvin of brightness
temperature, as a radiometric camera would give them) the span, the slope of the power spectrum, local contrast and
gradients. Their medians should lie within what 52 real frames of six drone cameras show between 5 and 95 %.

    scenegen render --map coastline --pairs 500 --pairs-per-clip 20 --clips-per-world 5 --size 640x512 --out COAST
    python benchmarks/picture_statistics.py COAST [MORE...] --plot statistics.png
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import ndimage

from scenegen.classes import CLASSES, Semantic
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.store import read_lock
from scenegen_render.sensor.scale import CountScale, counts_to_brightness_K

REAL = {
    "span p99-p1 [K]": (2.8, 8.6, 27.3),
    "spectrum slope 0.03-0.25": (-3.4, -3.0, -2.4),
    "local contrast, median [K]": (0.10, 0.29, 1.56),
    "local contrast, p90 [K]": (0.29, 1.05, 3.9),
    "gradient, median [K/px]": (0.08, 0.17, 0.48),
    "gradient, p99 [K/px]": (0.38, 1.6, 4.4),
}
"""5, 50 and 95 % of 52 distinct frames of DJI cameras, 640 x 512, by the definitions of `frame_statistics`."""
BLOCK_PX = 16
DEPTHS_M = np.geomspace(1.0, 3000.0, 80)


@dataclass(frozen=True, eq=False)
class Seen:
    """Everything measured in one dataset."""

    name: str
    frames: dict[str, np.ndarray]
    depth_histogram: np.ndarray
    sky: float
    beyond_100_m: float
    classes: Counter[str]


def frame_statistics(brightness_K: np.ndarray) -> dict[str, float]:
    """Numbers of one frame; isolated pixels that no neighbour supports are replaced first, as a camera does.

    Parameters
    ----------
    brightness_K : float64 (rows, columns)
    """
    image = _without_outliers(brightness_K)
    low, high = np.percentile(image, [1.0, 99.0])
    rows, columns = (n // BLOCK_PX * BLOCK_PX for n in image.shape)
    blocks = image[:rows, :columns].reshape(rows // BLOCK_PX, BLOCK_PX, columns // BLOCK_PX, BLOCK_PX)
    contrast = blocks.std(axis=(1, 3)).ravel()
    slope = np.hypot(np.diff(image, axis=1)[:-1], np.diff(image, axis=0)[:, :-1])
    values = (
        high - low, spectrum_slope(image, 0.03, 0.25), np.median(contrast), np.percentile(contrast, 90),
        np.median(slope), np.percentile(slope, 99),
    )  # fmt: skip
    return {name: float(value) for name, value in zip(REAL, values, strict=True)}


def _without_outliers(image: np.ndarray) -> np.ndarray:
    """Replace pixels far outside their eight neighbours by the median around them."""
    ring = np.ones((3, 3), bool)
    ring[1, 1] = False
    low, high = (ndimage.rank_filter(image, rank, footprint=ring) for rank in (1, -2))
    median = ndimage.median_filter(image, 3)
    detail = (image[:-1:2, :-1:2] - image[1::2, :-1:2] - image[:-1:2, 1::2] + image[1::2, 1::2]) / 2
    noise = np.median(np.abs(detail)) / 0.6745
    return np.where(np.abs(image - median) > 4 * (high - low) + 8 * noise, median, image)


def spectrum_slope(image: np.ndarray, low: float, high: float) -> float:
    """Log-log slope of the radial power spectrum between two frequencies [cycles/px].

    Hann window on the four corner squares, planes removed, axes left out (stripes), means in logarithmic rings.
    """
    size = min(image.shape)
    frequency = np.fft.fftfreq(size)
    radius = np.hypot(frequency[:, None], frequency)
    window = np.outer(np.hanning(size), np.hanning(size))
    power = np.zeros((size, size))
    for top in (0, image.shape[0] - size):
        for left in (0, image.shape[1] - size):
            power += np.abs(np.fft.fft2(_level(image[top : top + size, left : left + size]) * window)) ** 2
    off_axis = (np.abs(frequency)[:, None] > 1.5 / size) & (np.abs(frequency) > 1.5 / size)
    edges = np.geomspace(4 / size, 0.5, 25)
    ring = np.digitize(radius[off_axis], edges)
    mean = np.bincount(ring, power[off_axis], 26)[1:25] / np.maximum(np.bincount(ring, minlength=26)[1:25], 1)
    middle = np.sqrt(edges[1:] * edges[:-1])
    inside = (middle >= low) & (middle <= high) & (mean > 0)
    return float(np.polyfit(np.log(middle[inside]), np.log(mean[inside]), 1)[0])


def _level(square: np.ndarray) -> np.ndarray:
    """A square without its mean and tilt."""
    axis = np.linspace(-1.0, 1.0, len(square))
    tilt = (square.mean(axis=1) @ axis) / (axis @ axis) * axis[:, None] + (square.mean(axis=0) @ axis) / (
        axis @ axis
    ) * axis
    return np.asarray(square - square.mean() - tilt)


def measured(path: Path, most: int) -> Seen:
    """Read a dataset; thermal statistics of at most so many frames, evenly spread."""
    pairs = PairDataset(path, layers=("thermal", "depth", "semantic"))
    recipe = read_lock(path)["recipe"]
    scale = CountScale(
        *recipe["sensor"]["scale_K"], tuple(recipe["camera"]["band_um"]), recipe["sensor"]["linear_in"]
    )
    chosen = set(np.linspace(0, len(pairs) - 1, min(most, len(pairs))).astype(int).tolist())
    rows: list[dict[str, float]] = []
    histogram, total, sky, far = np.zeros(len(DEPTHS_M) - 1), 0, 0, 0
    classes: Counter[str] = Counter()
    for k in range(len(pairs)):
        sample = pairs[k]
        depth = sample["depth"]
        histogram += np.histogram(depth[np.isfinite(depth)], DEPTHS_M)[0]
        endless = np.isinf(depth)
        total, sky = total + depth.size, sky + int(endless.sum())
        far += int((depth[~endless] > 100.0).sum())
        classes.update(CLASSES[int(c)].name for c in np.unique(sample["semantic"]) if c != Semantic.SKY)
        if k in chosen:
            rows.append(frame_statistics(counts_to_brightness_K(sample["thermal"], scale).astype(np.float64)))
    table = {name: np.array([row[name] for row in rows]) for name in REAL}
    return Seen(path.name, table, histogram / total, sky / total, far / total, classes)


def told(seen: Seen) -> None:
    """Print what was found."""
    print(
        f"{seen.name}: sky {seen.sky:.1%}, surfaces beyond 100 m {seen.beyond_100_m:.1%} (bar 10 %),"
        f" {len(seen.classes)} classes (bar 12): "
        + ", ".join(f"{n} {c}" for n, c in seen.classes.most_common())
    )
    for name, (low, median, high) in REAL.items():
        five, half, ninety_five = np.percentile(seen.frames[name], [5, 50, 95])
        verdict = "inside" if low <= half <= high else "OUTSIDE"
        print(
            f"  {name:28s} median {half:6.2f} (5-95 %: {five:6.2f} to {ninety_five:6.2f});"
            f" real {median:5.2f} ({low} to {high}): {verdict}"
        )


def plot(all_seen: list[Seen], path: Path) -> None:
    """Draw distributions beside the real bands, and depth."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(2, 4, figsize=(18, 8), layout="constrained")
    for axis, (name, (low, median, high)) in zip(axes.ravel(), REAL.items(), strict=False):
        axis.axhspan(low, high, color="0.88", label="real frames, 5-95 %")
        axis.axhline(median, color="0.5", lw=1.2, label="real median")
        axis.boxplot(
            [seen.frames[name] for seen in all_seen], whis=(5, 95), showfliers=False,
            tick_labels=[seen.name for seen in all_seen],
        )  # fmt: skip
        axis.set_title(name)
        if "slope" not in name:
            axis.set_yscale("log")
    axes.ravel()[0].legend()
    for seen in all_seen:
        axes.ravel()[6].stairs(100 * seen.depth_histogram, DEPTHS_M, label=seen.name, lw=1.5)
    axes.ravel()[6].set(xscale="log", title="depth", xlabel="planar depth [m]", ylabel="% of pixels per bin")
    axes.ravel()[6].legend()
    names, far, sky = ([getattr(s, f) for s in all_seen] for f in ("name", "beyond_100_m", "sky"))
    axes.ravel()[7].bar(names, far, label="surfaces beyond 100 m")
    axes.ravel()[7].bar(names, sky, bottom=far, label="sky")
    axes.ravel()[7].set(title="far", ylabel="share of pixels")
    axes.ravel()[7].legend()
    figure.savefig(path, dpi=80)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("datasets", type=Path, nargs="+")
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--plot", type=Path)
    asked = parser.parse_args()
    all_seen = [measured(path, asked.frames) for path in asked.datasets]
    for seen in all_seen:
        told(seen)
    if asked.plot:
        plot(all_seen, asked.plot)


if __name__ == "__main__":
    main()
