"""Scale-invariant logarithmic error, and the learner of networks that need no judge."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from scenegen_trainers.inputs.knobs import TargetKnobs
from scenegen_trainers.inputs.target import decode
from scenegen_trainers.models.learner import Batch, Learner

VARIANCE_FOCUS = 0.85
"""Share of the mean log error that is forgiven (Lee et al., From Big to Small, 2019)."""
_SCALE, _NEAREST_M = 10.0, 0.1


def silog(
    estimate_m: Float[Tensor, "n 1 rows columns"],
    truth_m: Float[Tensor, "n 1 rows columns"],
    judged: Bool[Tensor, "n 1 rows columns"],
) -> Float[Tensor, ""]:
    """10 sqrt(mean(g^2) - 0.85 mean(g)^2) with g = log estimate - log truth (Eigen et al., NeurIPS 2014).

    Over judged pixels; 0 where there are none. Both depths count as 0.1 m at least.
    """
    error = estimate_m.clamp(min=_NEAREST_M).log() - truth_m.clamp(min=_NEAREST_M).log()
    error = torch.where(judged, error, torch.zeros_like(error))
    count = judged.sum().clamp(min=1)
    mean, square = error.sum() / count, (error**2).sum() / count
    return _SCALE * torch.sqrt((square - VARIANCE_FOCUS * mean**2).clamp(min=1e-8))


class SilogLearner(Learner):
    """One network, one loss.

    Parameters
    ----------
    network : torch.nn.Module
    target : TargetKnobs
    learning_rate : float
    """

    def __init__(self, network: Any, target: TargetKnobs, learning_rate: float) -> None:
        def adamw(module: Any) -> Any:
            return torch.optim.AdamW(module.parameters(), lr=learning_rate, weight_decay=1e-2)

        super().__init__({"network": network}, adamw, learning_rate)
        self._target = target

    @property
    def network(self) -> Any:
        """The only one."""
        return self.networks["network"]

    def step(self, batch: Batch) -> Mapping[str, Tensor]:
        """Learn metres, with depth capped as the target says."""
        estimate_m = decode(self.network(batch.image), self._target)
        loss = silog(estimate_m, batch.depth_m.clamp(max=self._target.cap_m), batch.judged)
        self.descend("network", loss)
        return {"silog": loss}
