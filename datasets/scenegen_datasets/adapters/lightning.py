"""Lightning: a data module over a dataset's splits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_datasets.adapters.torch import PairLoader, check_options, collate
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.sample import Sample

try:
    from lightning import LightningDataModule
except ImportError:
    raise InputError("the data module needs Lightning: pip install 'thermal-scenegen[train]'") from None


class PairModule(LightningDataModule):  # type: ignore[misc]
    """Training batches shuffled and divided among the trainer's ranks; validation and test batches in order.

    The position of the training loader goes into Lightning's checkpoints; a resumed fit goes on with the next batch.

    Parameters
    ----------
    path : str or Path
        Of the dataset.
    batch_size : int
    layers : sequence of str
    workers : int
        Reading processes of each loader.
    transform, collate_fn : callable
        As in `PairLoader`.
    seed : int
    clips_at_once : int
        As in `scenegen_datasets.epoch.Epoch`; for datasets behind URLs.
    **options
        Of `PairDataset`: ``seq_length``, ``storage_options``, ...
    """

    def __init__(
        self,
        path: str | Path,
        batch_size: int,
        *,
        layers: Sequence[str] = ("thermal", "depth"),
        workers: int = 0,
        transform: Callable[[Sample], Any] | None = None,
        collate_fn: Callable[[list[Any]], Any] = collate,
        seed: int = 0,
        clips_at_once: int = 0,
        **options: Any,
    ) -> None:
        super().__init__()
        check_options(options, PairDataset, PairModule)
        self._path, self._options = path, {"layers": tuple(layers), **options}
        self._loading: dict[str, Any] = {
            "batch_size": batch_size,
            "workers": workers,
            "transform": transform,
            "collate_fn": collate_fn,
        }
        self._training: PairLoader | None = None
        self._saved: dict[str, Any] | None = None
        self._order: dict[str, Any] = {"seed": seed, "clips_at_once": clips_at_once}

    def train_dataloader(self) -> PairLoader:
        """Batches of the split ``train``."""
        self._training = self._loader("train", **self._order)
        if self._saved is not None:
            self._training.load_state_dict(self._saved)
        return self._training

    def val_dataloader(self) -> PairLoader:
        """Batches of the split ``val``."""
        return self._loader("val", shuffle=False)

    def test_dataloader(self) -> PairLoader:
        """Batches of the split ``test``."""
        return self._loader("test", shuffle=False)

    def state_dict(self) -> dict[str, Any]:
        """How far training has come; part of every checkpoint."""
        return {} if self._training is None else self._training.state_dict()

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Let the training loader, which is made after this, go on from there."""
        self._saved = state or None

    def _loader(self, split: str, **order: Any) -> PairLoader:
        rank, ranks = (self.trainer.global_rank, self.trainer.world_size) if self.trainer else (0, 1)
        pairs = PairDataset(self._path, split, **self._options)
        return PairLoader(pairs, **self._loading, rank=rank, ranks=ranks, **order)
