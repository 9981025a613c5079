"""PyTorch: batches of tensors, seeded and resumable."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from inspect import signature
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError, nearest
from scenegen_datasets.epoch import Epoch
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.sample import Sample

try:
    import torch
    from torch.utils.data import DataLoader
except ImportError:
    raise InputError("batches of tensors need PyTorch: pip install 'thermal-scenegen[torch]'") from None

Batch = dict[str, Any]


def check_options(given: Iterable[str], *takers: Callable[..., Any]) -> None:
    """Refuse names that nobody takes where they are written, not where they would arrive.

    Raises
    ------
    InputError
        With the nearest name that one of the takers has.
    """
    known = {name for taker in takers for name in signature(taker).parameters} - {"options", "order"}
    for name in given:
        if name not in known:
            raise InputError(f"no option is called '{name}'{nearest(name, known)}")


def collate(samples: Sequence[Mapping[str, Any]]) -> Batch:
    """Join samples of `PairDataset`.

    Parameters
    ----------
    samples : sequence of mapping

    Returns
    -------
    dict
        Arrays and numbers become tensors with a leading axis, types as they are (``thermal`` uint16, ``depth``
        float32, ``K`` float64, ...); text, and arrays of unequal shapes (``imu``), become lists; ``facts`` a dict of
        the same.
    """
    return {name: _joined([sample[name] for sample in samples]) for name in samples[0]}


def _joined(values: list[Any]) -> Any:
    first = values[0]
    if isinstance(first, Mapping):
        return collate(values)
    if isinstance(first, np.ndarray):
        if all(value.shape == first.shape for value in values):
            return torch.from_numpy(np.stack(values))
        return [torch.from_numpy(value) for value in values]
    if isinstance(first, bool | int | float):
        return torch.tensor(values, dtype=torch.float64 if isinstance(first, float) else None)
    return values


class _Transformed:
    """A dataset and what is done to each of its samples, together in the worker."""

    def __init__(self, pairs: PairDataset, transform: Callable[[Sample], Any]) -> None:
        self.pairs, self.transform = pairs, transform

    def __len__(self) -> int:
        return len(self.pairs)

    def __getitem__(self, index: int) -> Any:
        return self.transform(self.pairs[index])


class _Batches:
    """Indices of the batches that are left of the current pass."""

    def __init__(self, epoch: Epoch, size: int, drop_last: bool) -> None:
        self.epoch, self.size, self.drop_last = epoch, size, drop_last

    def __len__(self) -> int:
        return self.number(len(self.epoch))

    def __iter__(self) -> Iterator[list[int]]:
        left = self.epoch.order()[self.epoch.position :]
        return iter([left[k * self.size :][: self.size].tolist() for k in range(self.number(len(left)))])

    def number(self, samples: int) -> int:
        return samples // self.size if self.drop_last else -(-samples // self.size)


class PairLoader:
    """Batches of a dataset: a `DataLoader` that follows an `Epoch` and knows how far its user has come.

    Each ``for batch in loader`` goes through the rest of the current pass. What a worker has read ahead but nobody has
    taken counts as unread, so ``state_dict()`` after any batch, loaded into a new loader, continues with the next one.

    Parameters
    ----------
    pairs : PairDataset
    batch_size : int
    workers : int
        Processes that read and decode; 0 reads in this one.
    transform : callable, optional
        What becomes of each sample, in the worker; with a `collate_fn` if it returns anything but a dict of arrays.
    collate_fn : callable
    drop_last : bool
        Leave out the last batch of a pass if it is not full.
    spawn : bool
        Start workers anew instead of forking this process: slower to start, safe beside threads and GPUs.
    pin_memory : bool
    **order
        Of `Epoch`: ``seed``, ``shuffle``, ``clips_at_once``, ``rank``, ``ranks``, ``even``.

    Attributes
    ----------
    epoch : Epoch
    """

    def __init__(
        self,
        pairs: PairDataset,
        batch_size: int,
        *,
        workers: int = 0,
        transform: Callable[[Sample], Any] | None = None,
        collate_fn: Callable[[list[Any]], Any] = collate,
        drop_last: bool = False,
        spawn: bool = True,
        pin_memory: bool = False,
        **order: Any,
    ) -> None:
        if batch_size < 1:
            raise InputError(f"batch_size is {batch_size}; it must be at least 1")
        check_options(order, Epoch, PairLoader)
        self.epoch = Epoch(pairs, **order)
        self._batches = _Batches(self.epoch, batch_size, drop_last)
        self._loader = DataLoader(
            pairs if transform is None else _Transformed(pairs, transform),
            batch_sampler=self._batches,
            num_workers=workers,
            collate_fn=collate_fn,
            multiprocessing_context="spawn" if workers and spawn else None,
            persistent_workers=workers > 0,
            pin_memory=pin_memory,
        )

    def __len__(self) -> int:
        """Batches of a whole pass."""
        return len(self._batches)

    def __iter__(self) -> Iterator[Any]:
        left = self._batches.number(len(self.epoch) - self.epoch.position)
        if not left:
            self.epoch.finish()
            return
        for batch in self._loader:
            left -= 1
            if left:
                self.epoch.advance(self._batches.size)
            else:  # now, not behind the loop: some users count batches and never ask for the end
                self.epoch.finish()
            yield batch

    def state_dict(self) -> dict[str, Any]:
        """Where the user is, as plain data."""
        return self.epoch.state_dict()

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continue behind the batch after which `state_dict` was taken; errors as `Epoch.load_state_dict`."""
        self.epoch.load_state_dict(state)
