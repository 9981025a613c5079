"""What it costs to open a dataset of a million frames: time, memory, and the way to a spawned worker.

Index and list of clips are as large and as sound as real ones; there are no shards, because opening touches none. Each
figure is that of a fresh process.

python benchmarks/million.py [--frames 1000000]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import frames as source
import loader
import numpy as np

from scenegen.foundation import canonical
from scenegen_datasets.description import read_description, sealed_description
from scenegen_datasets.index import ROW, write_index
from scenegen_datasets.job import ClipJob
from scenegen_datasets.manifest import file_sha256

CLIP_FRAMES = 65
ROUNDS = 3

OPENED = """
import time; wall, cpu = time.perf_counter(), time.process_time()
import json, pickle, sys
from pathlib import Path
from scenegen_datasets import PairDataset
def memory(what):
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(x.split()[1]) / 1024 for x in lines if x.startswith(what))
found = {"import_s": time.perf_counter() - wall, "import_MiB": memory("VmRSS")}
wall, cpu = time.perf_counter(), time.process_time()
pairs = PairDataset(sys.argv[1], "train")
found |= {"open_s": time.perf_counter() - wall, "open_cpu_s": time.process_time() - cpu, "open_MiB": memory("VmRSS")}
found["pairs"] = len(pairs)
wall = time.perf_counter()
sent = pickle.dumps(pairs)
found |= {"pickle_s": time.perf_counter() - wall, "pickle_bytes": len(sent)}
wall = time.perf_counter()
pickle.loads(sent)
found["unpickle_s"] = time.perf_counter() - wall
found["peak_MiB"] = memory("VmHWM")
print(json.dumps(found))
"""


def rows_of_clip(job: ClipJob) -> np.ndarray:
    """Sound rows, with checksums, that point nowhere."""
    rows = np.zeros(job.frames, ROW)
    rows["map"], rows["world"], rows["clip"] = job.map.encode(), job.world, job.clip
    rows["frames"], rows["ordinal"], rows["frame"] = job.frames, job.ordinal, np.arange(job.frames)
    rows["split"], rows["is_pair"] = ("train", "val", "test").index(job.split), rows["frame"] > 0
    rows["height_px"] = rows["width_px"] = 256
    for k in range(len(rows)):
        rows["row_crc32"][k] = zlib.crc32(rows[k].tobytes()[:-4])
    return rows


def build(root: Path, small: Path, total: int) -> None:
    """Index and list of clips of that many frames, described as those of a small dataset are."""
    split = {1: "val", 2: "test"}
    jobs = [
        ClipJob(k, "city", k // 8, k % 8, split.get(k // 8 % 10, "train"), CLIP_FRAMES - 1)
        for k in range(-(-total // CLIP_FRAMES))
    ]
    frames = len(jobs) * CLIP_FRAMES
    write_index(root / "index.npy", map(rows_of_clip, jobs), frames)
    line = json.loads((small / "clips.jsonl").read_bytes().splitlines()[0])
    with (root / "clips.jsonl").open("wb") as file:
        for job in jobs:
            file.write(canonical.canonical({**line, "job": vars(job)}) + b"\n")
    body = {k: v for k, v in read_description(small / "dataset.json").items() if k != "sums"}
    body["counts"] |= {"frames": frames, "clips": len(jobs), "pairs": frames - len(jobs)}
    sums = {name: file_sha256(root / name) for name in ("index.npy", "clips.jsonl")}
    (root / "dataset.json").write_bytes(sealed_description(body, sums))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=1_000_000)
    options = parser.parse_args()
    print(source.machine())
    with tempfile.TemporaryDirectory() as folder:
        small, root = Path(folder) / "small", Path(folder) / "million"
        small.mkdir()
        root.mkdir()
        build(root, loader.build(small, 32), options.frames)
        sizes = {p.name: f"{p.stat().st_size / 1e6:.1f} MB" for p in sorted(root.iterdir())}
        print(f"{options.frames:,} frames: {sizes}")
        for _ in range(ROUNDS):
            told = subprocess.run(
                [sys.executable, "-c", OPENED, str(root)], check=True, capture_output=True, text=True
            )
            found = json.loads(told.stdout)
            print(", ".join(f"{name} {value:.4g}" for name, value in found.items()))


if __name__ == "__main__":
    main()
