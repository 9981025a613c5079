"""Read pairs and sequences as numpy arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any


class PairDataset:
    """A dataset as a sequence of samples: ``len(d)``, ``d[i]`` -> dict of numpy arrays.

    Parameters
    ----------
    path : str or Path
    split : str or None
        ``train``, ``val``, ``test``; None for all.
    layers : sequence of str
        Which layers are decoded.
    seq_length : int
        Frames per sample; 1 gives single frames without a leading axis.
    frame_skip : int
        Frames left out between two of a sequence.
    seq_stride : int
        Distance between the starts of two sequences.
    allow_partial : bool
        Read what is there of a dataset that still grows.
    """

    def __init__(
        self,
        path: str | Path,
        split: str | None = None,
        layers: Sequence[str] = ("thermal", "depth"),
        seq_length: int = 1,
        frame_skip: int = 0,
        seq_stride: int = 1,
        allow_partial: bool = False,
    ) -> None:
        raise NotImplementedError

    def __len__(self) -> int:
        raise NotImplementedError

    def __getitem__(self, index: int) -> dict[str, Any]:
        raise NotImplementedError
