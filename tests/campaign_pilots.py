"""Pilots of the tests, good ones and bad ones."""

import numpy as np
import torch

from scenegen_flythrough.loop.pilot import Command, Decision, Observation


class Warm(torch.nn.Module):
    """Takes what is warmer than the frame's mean for near; sees a little by that, and certainly no truth."""

    def __init__(self, far_m: float = 60.0) -> None:
        super().__init__()
        self.far_m = far_m
        self.gain = torch.nn.Parameter(torch.tensor(0.01))

    def forward(self, counts: torch.Tensor, previous: torch.Tensor) -> torch.Tensor:
        both = 0.5 * (counts + previous)
        warm = (both - both.mean(dim=(1, 2), keepdim=True)) * self.gain
        return self.far_m * torch.sigmoid(-warm)


class NotANetwork:
    """Importable, but no torch module."""


class Climber:
    """A whole pilot of its own: straight up, away from everything."""

    name = "climber"
    needs: frozenset[str] = frozenset()

    def begin(self, flights: np.ndarray, seed: int) -> None:
        self.begun = len(flights)

    def act(self, seen: Observation) -> Decision:
        up = np.zeros((len(seen.flight), 3))
        up[:, 2] = 2.0
        return Decision(Command(up, seen.yaw_rad.copy()))


class Faulty(Climber):
    """Behaves, but for three flights: raises, flies at no number, turns to infinity."""

    name = "faulty"

    def act(self, seen: Observation) -> Decision:
        if seen.time_s > 0.5 and (seen.flight % 4 == 1).any():
            raise ZeroDivisionError("divided by zero & lost")
        decision = super().act(seen)
        decision.command.velocity_mps[seen.flight % 4 == 2] = np.nan
        decision.command.yaw_rad[seen.flight % 4 == 3] = np.inf
        return decision


def broken() -> None:
    raise ValueError("no weights here")


class OnlyDepth:
    """A source of depth: all is far."""

    name = "far"
    needs: frozenset[str] = frozenset({"thermal"})

    def estimate(self, seen: Observation) -> np.ndarray:
        assert seen.counts is not None
        return np.full(seen.counts.shape, 50.0, np.float32)
