"""What a network answers to the samples of a split, in order."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Float32, UInt8
from torch import Tensor

from scenegen_trainers.inputs.look import centred
from scenegen_trainers.training.samples import Draw, Samples


@dataclass(frozen=True, eq=False)
class Answer:
    """Of one sample.

    Attributes
    ----------
    position : int
        In `Samples`.
    image : uint8 (channels, rows, columns)
        Network input.
    estimate_m, truth_m : float32 (rows, columns)
        Planar depth [m].
    """

    position: int
    image: UInt8[np.ndarray, "channels rows columns"]
    estimate_m: Float32[np.ndarray, "rows columns"]
    truth_m: Float32[np.ndarray, "rows columns"]


def answers(
    metres: Callable[[Tensor], Tensor], samples: Samples, device: Any = "cpu", batch: int = 16
) -> Iterator[Answer]:
    """Ask about every sample.

    Parameters
    ----------
    metres : callable
        Composed inputs (n, channels, rows, columns) to depth (n, rows, columns) [m].
    samples : Samples
    device : torch device
    batch : int
        Samples asked about at once.
    """
    for first in range(0, len(samples), batch):
        some = range(first, min(first + batch, len(samples)))
        shown = [samples[Draw(position)] for position in some]
        images = torch.from_numpy(np.stack([centred(s.image) for s in shown])).to(device)
        with torch.inference_mode():
            depths = metres(images).cpu().numpy()
        for position, s, depth in zip(some, shown, depths, strict=True):
            yield Answer(position, s.image, np.asarray(depth, np.float32), s.depth_m)
