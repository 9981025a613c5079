"""What was actually drawn, against what the recipe asked for: hours, places, weather, flights, splits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from scenegen.foundation.words import counted
from scenegen_datasets.audits.asked import QUANTITIES, Facts, Quantity, Range, asked_range, evenly_drawn
from scenegen_datasets.audits.histogram import Histogram, even_edges
from scenegen_datasets.audits.verdict import Verdict, skipped

UNEVEN = 1e-3
"""Chance below which draws are called uneven: one in a thousand sound datasets and quantities is."""

_SPLIT_SHARES = {"train": 0.8, "val": 0.1, "test": 0.1}  # of worlds, unless whole maps are held out
_ROUNDING = 1e-9
_FEWEST = 8
_BINS = 24


@dataclass(frozen=True)
class Draw:
    """One quantity.

    Attributes
    ----------
    name, words, unit, per : str
    asked : (float, float) or None
        Range; None where a climatology of place and season decides.
    explicit : bool
        Whether the recipe names it.
    count : int
        Draws: worlds or clips.
    low, median, high : float
    covered : float or None
        Share of the asked range between the smallest and the largest value.
    outside : int
        Draws outside what was asked.
    chance : float or None
        How likely even draws are to look as uneven (Kolmogorov and Smirnov); None where evenness is not promised.
    histogram : Histogram
    """

    name: str
    words: str
    unit: str
    per: str
    asked: Range | None
    explicit: bool
    count: int
    low: float
    median: float
    high: float
    covered: float | None
    outside: int
    chance: float | None
    histogram: Histogram


@dataclass(frozen=True)
class Tally:
    """How often each of some names came up, and the shares that were asked for (empty: none)."""

    words: str
    counts: Mapping[str, int]
    asked: Mapping[str, float]


@dataclass(frozen=True)
class Draws:
    """Result of the audit: quantities, and tallies of maps, splits and styles."""

    verdict: Verdict
    clips: int
    worlds: int
    rejected: int
    draws: tuple[Draw, ...]
    tallies: tuple[Tally, ...]


def audit_draws(clips: Iterable[Facts], recipe: Mapping[str, Any]) -> Draws:
    """Compare all clips with the recipe.

    Parameters
    ----------
    clips : iterable of mapping
        Lines of ``clips.jsonl``.
    recipe : mapping
        The resolved recipe.
    """
    values: dict[str, list[float]] = {quantity.name: [] for quantity in QUANTITIES}
    seen: set[tuple[str, int]] = set()
    pairs: dict[str, Counter[str]] = {"maps": Counter(), "splits": Counter(), "styles": Counter()}
    count = rejected = 0
    for clip in clips:
        job = clip["job"]
        world = (str(job["map"]), int(job["world"]))
        for quantity in QUANTITIES:
            if (quantity.per == "clip" or world not in seen) and quantity.known(clip):
                values[quantity.name].append(quantity.fact(clip))
        seen.add(world)
        count, rejected = count + 1, rejected + int(clip["rejected"])
        pairs["maps"][world[0]] += int(job["pairs"])
        pairs["splits"][str(job["split"])] += int(job["pairs"])
        if "style" in clip.get("extra", {}):
            pairs["styles"][str(clip["extra"]["style"])] += 1
    if not count:
        return Draws(skipped("There is no clip yet."), 0, 0, 0, (), ())
    draws = tuple(
        _draw(quantity, np.array(found), recipe)
        for quantity, found in zip(QUANTITIES, values.values(), strict=True)
        if found
    )
    tallies = _tallies(pairs, recipe)
    return Draws(_verdict(draws, count, len(seen)), count, len(seen), rejected, draws, tallies)


def _draw(quantity: Quantity, values: Float64[np.ndarray, "draws"], recipe: Mapping[str, Any]) -> Draw:
    asked, explicit = asked_range(quantity, recipe)
    low, median, high = float(values.min()), float(np.median(values)), float(values.max())
    edges = asked if asked is not None and quantity.even else _round_range(low, high, asked)
    outside, covered, chance = 0, None, None
    if asked is not None:
        below, above = quantity.slack
        outside = int(
            np.sum((values < asked[0] - below - _ROUNDING) | (values > asked[1] + above + _ROUNDING))
        )
        if asked[1] > asked[0]:
            covered = (min(high, asked[1]) - max(low, asked[0])) / (asked[1] - asked[0])
            even = evenly_drawn(quantity, recipe) and len(values) >= _FEWEST
            chance = evenness((values - asked[0]) / (asked[1] - asked[0])) if even else None
    return Draw(
        quantity.name,
        quantity.words,
        quantity.unit,
        quantity.per,
        asked,
        explicit,
        len(values),
        low,
        median,
        high,
        covered,
        outside,
        chance,
        Histogram.of(values, even_edges(*edges, _BINS)),
    )


def evenness(places: Float64[np.ndarray, "draws"]) -> float:
    """How likely even draws from 0..1 are to lie as far from evenness as these do.

    The two-sided test of Kolmogorov and Smirnov with Stephens' correction for few draws (J. R. Stat. Soc. B 32, 1970).
    """
    from scipy.special import kolmogorov

    ordered, count = np.sort(places), len(places)
    steps = np.arange(count + 1) / count
    distance = max(float(np.max(steps[1:] - ordered)), float(np.max(ordered - steps[:-1])))
    root = float(np.sqrt(count))
    return float(kolmogorov((root + 0.12 + 0.11 / root) * distance))


def _round_range(low: float, high: float, asked: Range | None) -> Range:
    """A range for the chart that holds all values and, if it is finite and near, what was asked."""
    if asked is not None and asked[1] > asked[0]:
        low, high = min(low, asked[0]), max(high, asked[1])
    return low, high


def _tallies(found: Mapping[str, Counter[str]], recipe: Mapping[str, Any]) -> tuple[Tally, ...]:
    maps = [str(name) for name in recipe.get("map", ())]
    styles = [str(name) for name in recipe.get("flight", {}).get("styles", ())]
    asked = {
        "maps": {name: 1.0 / len(maps) for name in maps},
        "splits": {} if (recipe.get("splits") or {}).get("test_maps") else _SPLIT_SHARES,
        "styles": {name: styles.count(name) / len(styles) for name in dict.fromkeys(styles)},
    }
    words = {"maps": "pairs per map", "splits": "pairs per split", "styles": "clips per style"}
    return tuple(
        Tally(
            words[name],
            {key: found[name][key] for key in [*asked[name], *sorted(found[name] - asked[name].keys())]},
            asked[name],
        )
        for name in words
        if found[name]
    )


def _verdict(draws: Sequence[Draw], clips: int, worlds: int) -> Verdict:
    wrong = [draw for draw in draws if draw.outside]
    base = f"{counted(clips, 'clip')} of {counted(worlds, 'world')}."
    if wrong:
        names = ", ".join(f"{draw.words} ({draw.outside} of {draw.count})" for draw in wrong)
        return Verdict(
            "fault", "Some draws lie outside what the recipe asks for.", f"{base} Outside: {names}."
        )
    uneven = [draw.words for draw in draws if draw.chance is not None and draw.chance < UNEVEN]
    if uneven:
        words = f"{base} Everything lies in range, but hardly evenly: {', '.join(uneven)}."
        return Verdict("note", "Draws are in range, but not even.", words)
    words = f"{base} Every value lies in the range that was asked for, as evenly as chance has it."
    return Verdict("fine", "What was drawn is what was asked for.", words)
