"""``README.md``: the card that people and Hugging Face read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from scenegen_datasets.job import SPLITS

_HUB_SPLITS = {"train": "train", "val": "validation", "test": "test"}
_SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))


def card(description: Mapping[str, Any]) -> bytes:
    """Return the card of a dataset from its ``dataset.json``."""
    return "\n".join([*_front_matter(description), "", *_body(description), ""]).encode()


def _front_matter(d: Mapping[str, Any]) -> list[str]:
    """YAML header. Without `configs` a loader guesses, and may pick receipts for data."""
    size = next((name for limit, name in _SIZES if d["counts"]["frames"] < limit), "n>1M")
    lines = [
        "---",
        f"pretty_name: {json.dumps(d['name'])}",
        "task_categories:",
        "  - depth-estimation",
        "  - image-to-image",
        "tags:",
        "  - thermal",
        "  - lwir",
        "  - infrared",
        "  - optical-flow",
        "  - synthetic",
        "  - drone",
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
    layers = [
        f"| `{x['name']}` | `{x['member']}` | {x['dtype']} | {x['unit']} | {x['meaning']} |"
        for x in d["layers"]
    ]
    splits = [f"| {s} | {n['pairs']} | {n['clips']} | {n['worlds']} |" for s, n in d["splits"].items()]
    ranges = [f"| {name} | {low:.4g} | {high:.4g} |" for name, (low, high) in sorted(d["ranges"].items())]
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
        'pairs = PairDataset("PATH", split="train", layers=("thermal", "depth"))',
        "```",
        "",
        "Every shard is a plain tar in WebDataset naming; thermal and depth open with OpenCV, Pillow and Hugging Face",
        "`datasets` without this package. `sha256sum -c MANIFEST.sha256` checks every file.",
        "",
        "| layer | member | type | unit | meaning |",
        "|---|---|---|---|---|",
        *layers,
        "",
        "| split | pairs | clips | worlds |",
        "|---|---|---|---|",
        *splits,
        "",
        "Splits share no world. Ranges over the clips:",
        "",
        "| quantity | smallest | largest |",
        "|---|---|---|",
        *ranges,
        "",
        f"Version {d['version']}, recipe `{d['recipe_id'][:16]}`, content `{d['content_id'][:16]}`.",
    ]
