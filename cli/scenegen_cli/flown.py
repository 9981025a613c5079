"""What came of a campaign, in a table and a line for every comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenegen_cli.console import table

if TYPE_CHECKING:
    from scenegen_trainers.campaign.results import Results
    from scenegen_trainers.campaign.run import Campaign
    from scenegen_trainers.campaign.summary import Duel, Line, Spread


def in_words(campaign: Campaign, results: Results) -> str:
    """One row per map and pilot, and per point of a sweep; then each pair of pilots, mission by mission."""
    head = ("point", "map", "pilot", "flights", "collisions", "95 %", "goal", "timeout", "pilot failed")
    rows = [(*head, "progress", "speed", "latency"), *(_row(line) for line in results.lines)]
    if not campaign.swept:
        rows = [row[1:] for row in rows]
    return "\n".join([table(rows), *(_compared(duel, campaign.swept) for duel in results.duels)])


def _row(line: Line) -> tuple[str, ...]:
    hit = line.collision
    counts = [str(line.ends[kind].count) for kind in ("goal", "timeout", "pilot")]
    rate = f"{100 * hit.share:.2f} %" if hit.of else "-"
    return (
        line.point,
        line.map,
        line.pilot,
        str(line.flights),
        rate,
        f"{100 * hit.low:.1f}-{100 * hit.high:.1f}",
        *counts,
        _mean(line.progress, 100.0, "%"),
        _mean(line.speed_mps, 1.0, "m/s"),
        _mean(line.latency_ms, 1.0, "ms"),
    )


def _mean(spread: Spread, factor: float, unit: str) -> str:
    return "-" if spread.mean is None else f"{factor * spread.mean:.3g} {unit}"


def _compared(duel: Duel, swept: bool) -> str:
    where = f"{duel.map} {duel.point}" if swept else duel.map
    paired = duel.paired
    return (
        f"{where}: only {duel.first} collided on {paired.first_only} missions, only {duel.second} on "
        f"{paired.second_only}; McNemar p = {paired.p:.2g}"
    )
