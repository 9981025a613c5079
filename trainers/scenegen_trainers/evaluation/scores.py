"""The five scores by name: what they are called, how they are rounded, and which way is better."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from scenegen_trainers.metrics import DepthScores

NAMES = ("rmse_m", "rel", "delta1", "delta2", "delta3")
"""As reports for machines call them."""

HEADS = ("RMSE [m]", "Rel", "δ1", "δ2", "δ3")
"""As tables call them."""

DIGITS = (2, 3, 3, 3, 3)
"""Decimals that tables show."""

SMALLER_IS_BETTER: Mapping[str, bool] = MappingProxyType(
    {"rmse_m": True, "rel": True, "delta1": False, "delta2": False, "delta3": False}
)
"""Direction of each score."""


def named(scores: DepthScores) -> dict[str, float]:
    """Scores by name."""
    return dict(zip(NAMES, (scores.rmse_m, scores.rel, *scores.delta), strict=True))


def head_of(name: str) -> str:
    """What tables call a score."""
    return HEADS[NAMES.index(name)]


def figure(name: str, value: float) -> str:
    """A score as tables show it."""
    return f"{value:.{DIGITS[NAMES.index(name)]}f}"


def rounded(values: Mapping[str, float]) -> list[str]:
    """Scores as the cells of a table."""
    return [figure(name, values[name]) for name in NAMES]


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows))
