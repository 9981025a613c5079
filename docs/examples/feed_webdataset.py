"""Train on a dataset's shards with WebDataset, without any code of this project.

The stock decoders of images make everything 8-bit; OpenCV reads both members exactly, so bytes are decoded here.

    python feed_webdataset.py DATASET
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
import torch
import webdataset
from feed_pytorch import CAP_M, network


def decoded(sample: dict) -> tuple[torch.Tensor, torch.Tensor]:
    """A 16-bit PNG and a float TIFF."""
    thermal, depth = (
        cv2.imdecode(np.frombuffer(sample[name], np.uint8), cv2.IMREAD_UNCHANGED)
        for name in ("thermal.png", "depth.tiff")
    )
    thermal = (thermal.astype(np.float32) - 5000.0) / 3000.0
    return torch.from_numpy(thermal)[None], torch.from_numpy(np.minimum(depth, CAP_M) / CAP_M)[None]


def main(dataset: Path, epochs: int = 4) -> list[float]:
    """Train; returns the mean loss of each epoch."""
    torch.manual_seed(0)
    shards = sorted(str(path) for path in (dataset / "shards" / "train").rglob("*.tar"))
    pairs = webdataset.WebDataset(shards, shardshuffle=False).shuffle(64, seed=0).map(decoded).batched(4)
    model = network()
    optimiser = torch.optim.Adam(model.parameters(), 3e-3)
    losses = []
    for _ in range(epochs):
        seen = []
        for thermal, depth in pairs:
            loss = (model(thermal) - depth).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            seen.append(loss.item())
        losses.append(sum(seen) / len(seen))
    return losses


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
