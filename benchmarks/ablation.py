"""What each part of the paper's method is worth: the ablation it leaves as future work.

Every variant changes one thing of the proposed method at w_L1 = 100 (embedding interval, source of flow, gain,
normalisation of S, target, network), is trained with the same seeds on the same dataset, and judged on its test
split. Finished runs are kept, so a stopped ablation goes on.

    python benchmarks/ablation.py DATASET OUT [--profile ci] [--seeds 3] [--jobs 2] [--only flow]
"""

from __future__ import annotations

import argparse
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scenegen.foundation.canonical import read
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.resolve import Source
from scenegen_trainers.tables.names import SCORES
from scenegen_trainers.training.recipe import resolve_training

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
    "two frames, no flow": ("pix2pix", {"inputs": {"frames": 2}}),
    "logarithmic depth": ("pix2pix-flow", {"target": {"scale": "log"}}),
    "sky left out": ("pix2pix-flow", {"target": {"sky": "ignore"}}),
    "noise redrawn": ("pix2pix-flow", {"training": {"noise": "redrawn"}}),
    "FastDepth": ("fastdepth", {}),
    "Lite-Mono": ("litemono", {}),
}

NAMES = ("rmse_m", "rel", "delta1")


def tasks(options: argparse.Namespace) -> list[Task]:
    """One for each variant and seed, seed by seed."""
    found = []
    for seed in range(options.seeds):
        for name, (model, keys) in VARIANTS.items():
            if options.only in name:
                recipe = resolve_training(model, options.profile, [Source("", {**keys, "seed": seed})])
                payload = {"recipe": recipe.model_dump(mode="json"), "out": str(run(options, name, seed))}
                found.append(Task(f"{name}, seed {seed}", f"{name}, seed {seed}", payload))
    return found


def run(options: argparse.Namespace, name: str, seed: int) -> Path:
    """Directory of a run."""
    return Path(options.out, f"{''.join(c if c.isalnum() else '-' for c in name)}-seed{seed}")


def main() -> None:
    """Run what is missing, print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset")
    parser.add_argument("out")
    parser.add_argument("--profile", default="ci")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="")
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
    print("\n| variant | RMSE [m] | Rel | δ1 | Rel, median-aligned |\n|---|---|---|---|---|")
    for name in (n for n in VARIANTS if options.only in n):
        paths = [run(options, name, seed) / SCORES for seed in range(options.seeds)]
        scores = [read(path) for path in paths if path.is_file()]
        if scores:
            cells = [cell([s["pooled"][n] for s in scores]) for n in NAMES]
            print(f"| {name} | {' | '.join(cells)} | {cell([s['pooled_aligned']['rel'] for s in scores])} |")


def cell(values: list[float]) -> str:
    """Mean, and spread over seeds."""
    return f"{fmean(values):.3f}" + (f" ± {stdev(values):.3f}" if len(values) > 1 else "")


if __name__ == "__main__":
    main()
