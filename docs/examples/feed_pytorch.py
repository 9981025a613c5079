"""Train on a dataset with plain PyTorch: a loader, a network, a loop.

python feed_pytorch.py DATASET
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.utils.data import DataLoader

from scenegen_datasets import PairDataset

CAP_M = 100.0


def pair(sample: dict) -> tuple[torch.Tensor, torch.Tensor]:
    """Counts to numbers around 0, depth to shares of the cap; sky is as far as it gets."""
    thermal = (sample["thermal"].astype(np.float32) - 5000.0) / 3000.0
    depth = np.minimum(sample["depth"], CAP_M) / CAP_M
    return torch.from_numpy(thermal)[None], torch.from_numpy(depth)[None]


def collate(samples: list[dict]) -> tuple[torch.Tensor, torch.Tensor]:
    """Stack a batch."""
    thermal, depth = zip(*map(pair, samples), strict=True)
    return torch.stack(thermal), torch.stack(depth)


def network() -> nn.Module:
    """Any network; this one is small."""
    layers = [nn.Conv2d(1, 16, 5, padding=2), nn.ReLU(), nn.Conv2d(16, 16, 5, padding=2), nn.ReLU()]
    return nn.Sequential(*layers, nn.Conv2d(16, 1, 1), nn.Sigmoid())


def main(dataset: Path, epochs: int = 4) -> list[float]:
    """Train; returns the mean loss of each epoch."""
    torch.manual_seed(0)
    loader = DataLoader(PairDataset(dataset, "train"), batch_size=4, shuffle=True, collate_fn=collate)
    model = network()
    optimiser = torch.optim.Adam(model.parameters(), 3e-3)
    losses = []
    for _ in range(epochs):
        seen = []
        for thermal, depth in loader:
            loss = (model(thermal) - depth).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            seen.append(loss.item())
        losses.append(sum(seen) / len(seen))
    return losses


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
