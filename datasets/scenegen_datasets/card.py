"""``README.md``: the card that people and Hugging Face read, and the datasheet of the data (Gebru et al., 2021)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from scenegen_datasets.info import worlds_in_words
from scenegen_datasets.job import SPLITS
from scenegen_datasets.licence import hub_lines, licence_of, licence_url
from scenegen_datasets.splits.held_out import HeldOut

_HUB_SPLITS = {"train": "train", "val": "validation", "test": "test"}
_SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))

_MOTIVATION = """\
Depth from a thermal camera lets a drone fly at night. Recording thermal images with dense metric depth and flow
outdoors needs a lidar, a calibrated rig and luck with the weather; simulators that paint objects in one grey each
teach a network to read the paint. This dataset stands between the two: temperatures follow from a heat balance of
material, hour, weather, orientation and shadow, and depth, flow and labels are exact."""

_PROCESS = """\
Worlds are procedural. The temperature of every surface follows from a periodic heat balance (sun, sky, wind,
neighbours, conduction); a ray tracer carries band radiance through the air to the camera; a microbolometer model
(lens, lag, noise of pixels, rows and columns, 14-bit scale) makes counts of it. Nothing in the images was recorded,
collected from people, or labelled by hand. `recipe.lock.json` holds every setting and version: the same recipe
gives the same data again."""

_USES = """\
* depth from thermal images, alone or with the frame before; optical flow and its limits on low-contrast images
* segmentation and detection from temperature; sensor studies with other noise on the stored radiance (`scenegen sense`)
* pretraining before real thermal images, and ablations that no recording allows: the same flight at another hour

Not for: absolute radiometry of real places, the looks of particular cities, recognising persons, or the last step
before a machine flies among people without tests on real images."""

_LIMITS = """\
* Plants, people and vehicles are simple bodies with a handful of temperatures; heat stands still during a clip.
* Diffuse surfaces reflect what was baked for them; only glass, water and bare metal mirror, once.
* There is no rain, snow or fog in the air, and no lens flare, vignetting or shutter event in the camera.
* Labels come from the centre of a pixel, radiance from its area: at silhouettes they can disagree."""


def card(description: Mapping[str, Any]) -> bytes:
    """Return the card of a dataset from its ``dataset.json``."""
    return "\n".join([*_front_matter(description), "", *_body(description), ""]).encode()


def _front_matter(d: Mapping[str, Any]) -> list[str]:
    """YAML header. Without `configs` a loader guesses, and may pick receipts for data."""
    size = next((name for limit, name in _SIZES if d["counts"]["frames"] < limit), "n>1M")
    lines = [
        "---",
        f"pretty_name: {json.dumps(d['name'])}",
        *hub_lines(licence_of(d)),
        "task_categories:",
        "  - depth-estimation",
        "  - image-to-image",
        "tags:",
        *(f"  - {tag}" for tag in ("thermal", "lwir", "infrared", "optical-flow", "synthetic", "drone")),
        "  - webdataset",
        "size_categories:",
        f"  - {size}",
        "configs:",
        "  - config_name: default",
        "    data_files:",
    ]
    for split in SPLITS:
        if d["splits"][split]["clips"]:
            lines += [f"      - split: {_HUB_SPLITS[split]}", f'        path: "shards/{split}/*/*.tar"']
    return [*lines, "---"]


def _body(d: Mapping[str, Any]) -> list[str]:
    counts, grid = d["counts"], d["grid"]
    return [
        f"# {d['name']}",
        "",
        f"{counts['pairs']} pairs of thermal (LWIR, {d['band_um'][0]:g}-{d['band_um'][1]:g} um) and metric depth "
        f"images, {grid['width_px']}x{grid['height_px']}, from {counts['worlds']} procedural worlds "
        f"({', '.join(d['maps'])}), rendered by thermal-scenegen.",
        "",
        "```python",
        "from scenegen_datasets import PairDataset",
        "",
        'pairs = PairDataset("PATH", split="train", layers=("thermal", "depth"))  # a directory or a URL',
        "```",
        "",
        "Every shard is a plain tar in WebDataset naming; thermal and depth open with OpenCV, Pillow and Hugging Face",
        "`datasets` without this package. `sha256sum -c MANIFEST.sha256` checks every file.",
        *_section("Why it exists", [_MOTIVATION]),
        *_section("What is in it", _composition(d)),
        *_section("How it was made", [_PROCESS]),
        *_section("What it is for", [_USES]),
        *_section("Limits", [_LIMITS]),
        *_section("Licence", _licence(d)),
    ]


def _section(title: str, lines: list[str]) -> list[str]:
    return ["", f"## {title}", "", *lines]


def _composition(d: Mapping[str, Any]) -> list[str]:
    layers = [
        f"| `{x['name']}` | `{x['member']}` | {x['dtype']} | {x['unit']} | {x['meaning']} |"
        for x in d["layers"]
    ]
    splits = [f"| {s} | {n['pairs']} | {n['clips']} | {n['worlds']} |" for s, n in d["splits"].items()]
    ranges = [f"| {name} | {low:.4g} | {high:.4g} |" for name, (low, high) in sorted(d["ranges"].items())]
    conventions = [f"* {name}: {meaning}" for name, meaning in d["conventions"].items()]
    missing = [f"{len(d['missing'])} planned clips could not be made and are left out.", ""]
    return [
        "| layer | member | type | unit | meaning |",
        "|---|---|---|---|---|",
        *layers,
        "",
        *conventions,
        "",
        "| split | pairs | clips | worlds |",
        "|---|---|---|---|",
        *splits,
        "",
        *_split_rule(d),
        "",
        *_parts(d),
        "Ranges over the clips:",
        "",
        "| quantity | smallest | largest |",
        "|---|---|---|",
        *ranges,
        "",
        *(missing if d["missing"] else []),
        "It holds no personal data: people in it are figures without faces or names.",
    ]


def _split_rule(d: Mapping[str, Any]) -> list[str]:
    """What keeps the splits apart: worlds, and what only the test split may show."""
    rule = d["split_rule"]
    val, test = (" and ".join(map(str, rule[split])) for split in ("val", "test"))
    held = HeldOut.of_statement(rule["held_out_for_test"]).words
    lines = [
        f"Splits share no world: of every {rule['period']} worlds of a map, number {val} is for validation, number "
        f"{test} for test, the rest for training."
    ]
    if not held:
        return [*lines, "Hours, weather and maps of all splits are drawn alike; none is kept for testing."]
    return [
        *lines,
        "Held out, so that no clip for training or validation shows it and the test split measures what it costs:",
        "",
        *(f"* {words}" for words in held),
        "",
        "`clips.jsonl` says which test clips show what, by their hour, weather and map.",
    ]


def _parts(d: Mapping[str, Any]) -> list[str]:
    """Datasets that were merged into this one."""
    if not d["parts"]:
        return []
    rows = [
        f"| {part['name']} | {part['version']} | {part['counts']['pairs']} | {worlds_in_words(part)} | "
        f"`{part['recipe_id'][:16]}` | `{part['content_id'][:16]}` |"
        for part in d["parts"]
    ]
    return [
        "It was merged of",
        "",
        "| dataset | version | pairs | worlds here | recipe | content |",
        "|---|---|---|---|---|---|",
        *rows,
        "",
    ]


def _licence(d: Mapping[str, Any]) -> list[str]:
    name = licence_of(d)
    return [
        f"The data are licensed under [{name}]({licence_url(name)}).",
        "",
        f"Version {d['version']}, recipe `{d['recipe_id'][:16]}`, content `{d['content_id'][:16]}`.",
    ]
