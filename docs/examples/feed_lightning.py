"""Train on a dataset with Lightning's Trainer.

python feed_lightning.py DATASET
"""

from __future__ import annotations

import sys
from pathlib import Path

import lightning
import torch
from feed_pytorch import collate, network
from torch.utils.data import DataLoader

from scenegen_datasets import PairDataset


class Depth(lightning.LightningModule):
    """Absolute error, Adam."""

    def __init__(self) -> None:
        super().__init__()
        self.model = network()
        self.losses: list[float] = []

    def training_step(self, batch: tuple[torch.Tensor, torch.Tensor], index: int) -> torch.Tensor:
        """One batch."""
        thermal, depth = batch
        loss = (self.model(thermal) - depth).abs().mean()
        self.losses.append(float(loss.detach()))
        return loss

    def configure_optimizers(self) -> torch.optim.Optimizer:
        """What it learns by."""
        return torch.optim.Adam(self.parameters(), 3e-3)


def main(dataset: Path, epochs: int = 4) -> list[float]:
    """Train; returns the mean loss of each epoch."""
    lightning.seed_everything(0, verbose=False)
    loader = DataLoader(PairDataset(dataset, "train"), batch_size=4, shuffle=True, collate_fn=collate)
    module = Depth()
    trainer = lightning.Trainer(
        max_epochs=epochs,
        accelerator="cpu",
        logger=False,
        enable_checkpointing=False,
        enable_progress_bar=False,
        enable_model_summary=False,
    )
    trainer.fit(module, loader)
    count = len(loader)
    return [sum(module.losses[k * count : (k + 1) * count]) / count for k in range(epochs)]


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
