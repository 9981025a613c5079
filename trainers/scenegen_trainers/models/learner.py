"""What the training loop knows of a model: networks, their optimisers, one step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor


@dataclass(frozen=True, eq=False)
class Batch:
    """Some samples, on the device.

    Attributes
    ----------
    image : (n, channels, rows, columns)
        Network input in -1..1.
    code : (n, 1, rows, columns)
        True depth as painted, in -1..1.
    judged : bool (n, 1, rows, columns)
        Pixels that count in the loss.
    depth_m : float32 (n, 1, rows, columns)
        True depth [m], sky +inf.
    """

    image: Float[Tensor, "n channels rows columns"]
    code: Float[Tensor, "n 1 rows columns"]
    judged: Bool[Tensor, "n 1 rows columns"]
    depth_m: Float32[Tensor, "n 1 rows columns"]

    def to(self, device: Any) -> Batch:
        """The same on another device."""
        return Batch(*(getattr(self, field.name).to(device) for field in fields(self)))


class Learner(ABC):
    """Networks that learn together.

    Parameters
    ----------
    networks : dict of str to torch.nn.Module
    optimiser : callable
        Makes the optimiser of one network.
    learning_rate : float
        At the start.
    """

    def __init__(
        self, networks: Mapping[str, Any], optimiser: Callable[[Any], Any], learning_rate: float
    ) -> None:
        self.networks = dict(networks)
        self.optimisers = {name: optimiser(network) for name, network in networks.items()}
        self._learning_rate = learning_rate
        self._fabric: Any = None

    def move_to(self, fabric: Any) -> None:
        """Let Lightning Fabric place networks and optimisers on devices, in their precision."""
        self._fabric = fabric
        for name, network in self.networks.items():
            # As convolutions on a CPU like it: up to a third faster.
            network.to(memory_format=torch.channels_last)
            self.networks[name], self.optimisers[name] = fabric.setup(network, self.optimisers[name])

    def precision(self) -> Any:
        """Context in which a bare module computes as the wrapped ones do."""
        return self._fabric.autocast()

    def set_rate(self, share: float) -> float:
        """Take `share` of the learning rate from here on; returns it."""
        rate = self._learning_rate * share
        for optimiser in self.optimisers.values():
            for group in optimiser.param_groups:
                group["lr"] = rate
        return rate

    def descend(self, name: str, loss: Tensor) -> None:
        """One step of one network down its loss."""
        self.optimisers[name].zero_grad(set_to_none=True)
        self._fabric.backward(loss)
        self.optimisers[name].step()

    def state(self) -> dict[str, Any]:
        """Everything a resumed training needs, as tensors and plain data."""
        return {
            "networks": {name: network.state_dict() for name, network in self.networks.items()},
            "optimisers": {name: optimiser.state_dict() for name, optimiser in self.optimisers.items()},
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from a state."""
        for name, network in self.networks.items():
            network.load_state_dict(state["networks"][name])
        for name, optimiser in self.optimisers.items():
            optimiser.load_state_dict(state["optimisers"][name])

    @property
    @abstractmethod
    def network(self) -> Any:
        """The one that estimates depth."""

    @abstractmethod
    def step(self, batch: Batch) -> Mapping[str, Tensor]:
        """Learn from one batch; returns the losses."""
