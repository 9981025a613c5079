"""What each part of the paper's method is worth: the ablation it leaves as future work.

Every variant changes one thing of the proposed method at w_L1 = 100 (embedding interval, source of flow, gain,
normalisation of S, target, network), is trained with the same seeds on the same dataset, and judged on its test
split. Finished runs are kept, so a stopped ablation goes on.

    python benchmarks/ablation.py DATASET OUT [--profile ci] [--seeds 3] [--jobs 2] [--steps N] [--only "no flow" dis]

OUT receives ``ablation.md`` and ``ablation.json`` beside the runs.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty, read
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.resolve import Source
from scenegen_trainers.tables.names import SCORES
from scenegen_trainers.tables.order import judge
from scenegen_trainers.tables.paper import Relation
from scenegen_trainers.training.recipe import resolve_training

_BESIDE = {"flow": "dis", "flow_scale": "full", "flow_shown": "channel"}
"""DIS flow in pixels, whole, in a channel beside the image."""

VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "as proposed": ("pix2pix-flow", {}),
    "no flow": ("pix2pix", {}),
    "interval 2": ("pix2pix-flow", {"inputs": {"interval": 2}}),
    "interval 10": ("pix2pix-flow", {"inputs": {"interval": 10}}),
    "flow alone (interval 1)": ("pix2pix-flow", {"inputs": {"interval": 1}}),
    "flow by DIS": ("pix2pix-flow", {"inputs": {"flow": "dis"}}),
    "true flow": ("pix2pix-flow", {"inputs": {"flow": "truth"}}),
    "true flow, scale kept": ("pix2pix-flow", {"inputs": {"flow": "truth", "flow_scale": "full"}}),
    "flow on the previous grid": ("pix2pix-flow", {"inputs": {"flow_grid": "previous"}}),
    "gain min to max": ("pix2pix-flow", {"inputs": {"gain": "minmax"}}),
    "gain CLAHE": ("pix2pix-flow", {"inputs": {"gain": "clahe"}}),
    "gain of each frame": ("pix2pix-flow", {"inputs": {"gain_shared": False}}),
    "S by grey value": ("pix2pix-flow", {"inputs": {"simplified": "luma"}}),
    "S keeps scale": ("pix2pix-flow", {"inputs": {"flow_scale": "full"}}),
    "DIS, S keeps scale": ("pix2pix-flow", {"inputs": {"flow": "dis", "flow_scale": "full"}}),
    "DIS, S keeps scale, a channel of its own": ("pix2pix-flow", {"inputs": _BESIDE}),
    "two frames, no flow": ("pix2pix", {"inputs": {"frames": 2}}),
    "logarithmic depth": ("pix2pix-flow", {"target": {"scale": "log"}}),
    "sky left out": ("pix2pix-flow", {"target": {"sky": "ignore"}}),
    "noise redrawn": ("pix2pix-flow", {"training": {"noise": "redrawn"}}),
    "FastDepth": ("fastdepth", {}),
    "FastDepth, linear depth": ("fastdepth", {"target": {"scale": "linear"}}),
    "FastDepth, sky left out": ("fastdepth", {"target": {"sky": "ignore"}}),
    "FastDepth, two frames": ("fastdepth", {"inputs": {"frames": 2}}),
    "FastDepth, DIS in a channel": ("fastdepth", {"inputs": _BESIDE}),
    "FastDepth, DIS in a channel, sky left out": (
        "fastdepth",
        {"inputs": _BESIDE, "target": {"sky": "ignore"}},
    ),
    "Lite-Mono": ("litemono", {}),
    "Lite-Mono, DIS in a channel": ("litemono", {"inputs": _BESIDE}),
    "Lite-Mono, DIS in a channel, sky left out": (
        "litemono",
        {"inputs": _BESIDE, "target": {"sky": "ignore"}},
    ),
}

BASE = "as proposed"
"""What every variant is held against, seed by seed."""

HEAD = (
    "variant",
    "RMSE [m]",
    "Rel",
    "δ1",
    "δ1, median-aligned",
    "RMSE with sky as cap [m]",
    "δ1 against the proposed",
)
COLUMNS = (
    ("pooled", "rmse_m", 2),
    ("pooled", "rel", 3),
    ("pooled", "delta1", 3),
    ("pooled_aligned", "delta1", 3),
    ("painted", "rmse_m", 2),
)


def chosen(only: Sequence[str]) -> list[str]:
    """Variants whose name holds one of some words; all for none."""
    return [name for name in VARIANTS if not only or any(word.lower() in name.lower() for word in only)]


def tasks(options: argparse.Namespace) -> list[Task]:
    """One for each variant and seed, seed by seed."""
    found = []
    for seed in range(options.seeds):
        for name in chosen(options.only):
            model, keys = VARIANTS[name]
            steps = {"training": {"steps": options.steps}} if options.steps else {}
            sources = [Source("", keys), Source("", {**steps, "seed": seed})]
            recipe = resolve_training(model, options.profile, sources)
            payload = {"recipe": recipe.model_dump(mode="json"), "out": str(run(options, name, seed))}
            found.append(Task(f"{name}, seed {seed}", f"{name}, seed {seed}", payload))
    return found


def run(options: argparse.Namespace, name: str, seed: int) -> Path:
    """Directory of a run."""
    return Path(options.out, f"{''.join(c if c.isalnum() else '-' for c in name)}-seed{seed}")


def main() -> None:
    """Run what is missing, write a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset")
    parser.add_argument("out")
    parser.add_argument("--profile", default="ci")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--steps", type=int, default=0)
    parser.add_argument("--only", nargs="*", default=())
    options = parser.parse_args()
    Path(options.out).mkdir(parents=True, exist_ok=True)
    setup = {"data": str(Path(options.dataset).resolve()), "split": "test"}
    one_thread = {"OMP_NUM_THREADS": "1"}
    with Pool(
        "scenegen_trainers.tables.worker:worker", setup, options.jobs, environment=one_thread, silence_s=3600
    ) as pool:
        for event in pool.run(tasks(options)):
            if isinstance(event, Done | Failed):
                said = "done" if isinstance(event, Done) else event.failure.message
                print(f"{event.task.key}: {said}", flush=True)
    scores = collected(options)
    write_atomic(Path(options.out, "ablation.json"), pretty(scores))
    page = "\n".join(f"| {' | '.join(cells)} |" for cells in (HEAD, ["---"] * len(HEAD), *rows(scores)))
    write_atomic(Path(options.out, "ablation.md"), f"{page}\n".encode())
    print(f"\n{page}")


def collected(options: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """Scores of all finished runs: by variant, then by seed."""
    found: dict[str, dict[str, Any]] = {}
    for name in chosen(options.only):
        for seed in range(options.seeds):
            path = run(options, name, seed) / SCORES
            if path.is_file():
                found.setdefault(name, {})[str(seed)] = read(path)
    return found


def rows(scores: Mapping[str, Mapping[str, Any]]) -> list[list[str]]:
    """Variants, with how many seeds they have where others have more, then the answers that look at no image."""
    most = max(map(len, scores.values()), default=0)
    lines = [
        [
            name if len(runs) == most else f"{name} ({len(runs)})",
            *values(list(runs.values())),
            against(name, scores),
        ]
        for name, runs in scores.items()
    ]
    first = next((run for runs in scores.values() for run in runs.values()), None)
    trivial = {} if first is None else first["baselines"]
    return lines + [[f"{name}, no image", *values([own]), ""] for name, own in trivial.items()]


def values(runs: Sequence[Mapping[str, Any]]) -> list[str]:
    """Mean, and spread over seeds, of each column."""
    return [cell([float(run[kind][score]) for run in runs], digits) for kind, score, digits in COLUMNS]


def against(name: str, scores: Mapping[str, Mapping[str, Any]]) -> str:
    """By how much δ1 is better than that of the proposed method, and the verdict over seeds that both have."""
    if name == BASE or BASE not in scores:
        return ""
    seeds = sorted(scores[name].keys() & scores[BASE].keys())
    if len(seeds) < 2:
        return ""
    runs = {key: [float(scores[key][seed]["pooled"]["delta1"]) for seed in seeds] for key in (name, BASE)}
    found = judge(Relation("", (name,), (BASE,)), "delta1", runs)
    word = {"held": "better", "open": "open", "not held": "worse"}[found.verdict]
    return f"{found.margin:+.3f}, {word}"


def cell(values: Sequence[float], digits: int) -> str:
    """Mean, and spread over seeds."""
    return f"{fmean(values):.{digits}f}" + (f" ± {stdev(values):.{digits}f}" if len(values) > 1 else "")


if __name__ == "__main__":
    main()
