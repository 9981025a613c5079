"""Train on a dataset through Hugging Face's `datasets`, which reads the card in its README.

python feed_hugging_face.py DATASET
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import torch
from datasets import load_dataset
from feed_pytorch import CAP_M, network


def decoded(batch: dict) -> tuple[torch.Tensor, torch.Tensor]:
    """Pillow pictures: 16-bit grey, and float."""
    thermal = np.stack([np.asarray(p, np.float32) for p in batch["thermal.png"]])
    depth = np.stack([np.asarray(p, np.float32) for p in batch["depth.tiff"]])
    tensors = (
        torch.from_numpy((thermal - 5000.0) / 3000.0),
        torch.from_numpy(np.minimum(depth, CAP_M) / CAP_M),
    )
    return tensors[0][:, None], tensors[1][:, None]


def main(dataset: Path, epochs: int = 4) -> list[float]:
    """Train; returns the mean loss of each epoch."""
    torch.manual_seed(0)
    pairs = load_dataset(str(dataset), split="train", streaming=True)
    model = network()
    optimiser = torch.optim.Adam(model.parameters(), 3e-3)
    losses = []
    for _ in range(epochs):
        seen = []
        for batch in pairs.iter(batch_size=4):
            thermal, depth = decoded(batch)
            loss = (model(thermal) - depth).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            seen.append(loss.item())
        losses.append(sum(seen) / len(seen))
    return losses


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
