"""Sides that a network can halve often enough."""

from __future__ import annotations

from jaxtyping import Float
from torch import Tensor
from torch.nn import functional


def padded(
    image: Float[Tensor, "n channels rows columns"], multiple: int
) -> Float[Tensor, "n channels more_rows more_columns"]:
    """Repeat the right and lower border until both sides are multiples of `multiple`."""
    rows, columns = image.shape[-2:]
    if rows % multiple == 0 and columns % multiple == 0:
        return image
    return functional.pad(image, (0, -columns % multiple, 0, -rows % multiple), mode="replicate")
