"""Table 2 in words and cells, which page and Markdown share. Nothing in it differs between two runs of a table."""

from __future__ import annotations

from collections.abc import Sequence

from scenegen.foundation.words import counted
from scenegen_trainers.campaign.statistics import Paired, Rate
from scenegen_trainers.campaign.summary import KINDS, Line, Spread
from scenegen_trainers.evaluation.scores import markdown
from scenegen_trainers.tables.entrants import Entrant
from scenegen_trainers.tables.names import BOUNDS
from scenegen_trainers.tables.table2 import Table2
from scenegen_trainers.tables.table2_paper import (
    LEFT_OUT,
    METHODS,
    PUBLISHED,
    Method,
    published_mean,
    published_words,
)

Cells = Sequence[str]
LEVEL = 0.05
"""A smaller p is called a difference."""

NOTE = (
    "Collision rate: flights that touched anything over all flights, with k/N and Wilson's 95 % interval; a mean over "
    "maps weighs them alike. p: McNemar's exact test on the missions that ended differently for the two methods, with "
    "those on which only the conventional and only the proposed one collided; open: p of 0.05 or more. The bounds fly "
    "the same missions: oracle by true depth, blind by none. Flights are taken for independent; those of one world "
    "share its streets."
)
AVERAGES = (
    "The paper's own averages, 19.25 and 12.50, leave City out; over its four maps they are 28.90 and 22.33. Its "
    "figures stand beside ours for their order, not for their size: its planner, speed, missions and latency are "
    "unknown. Its intervals are Wilson's on the counts its figures come from; City's are no counts out of 400, and 83 "
    "is the smallest number of flights that gives both."
)


def title(table: Table2) -> str:
    """Heading."""
    return f"Table 2: collision rates, {table.job.flights:,} flights a map"


def about(table: Table2) -> str:
    """Who flew, where, how; one paragraph."""
    job, recipe = table.job, table.job.recipe
    camera, loop = recipe.dataset.camera, recipe.loop
    late = (
        "measured latency" if loop.latency == "measured" else f"{loop.latency_ms:g} ms from frame to command"
    )
    worlds = sum(len({batch.world for batch in plan}) for plan in job.campaign.plans.values())
    where = (
        f"dataset {job.dataset['name']} {job.dataset['version']}"
        if job.dataset
        else "no dataset in particular"
    )
    return (
        f"{' '.join(f'{_network(entrant)}.' for entrant in job.entrants)} "
        f"{counted(worlds, f'{recipe.campaign.split} world')} of seed "
        f"{recipe.dataset.seed} ({where}), camera {camera.width_px}x{camera.height_px}, {camera.hfov_deg:g} deg, NETD "
        f"{recipe.dataset.sensor.netd_mk:g} mK; planner {job.planner}, cruise {loop.cruise_mps:g} m/s, {late}."
    )


def warnings(table: Table2) -> list[str]:
    """What a reader has to know before any figure."""
    said = []
    seen = table.job.dataset.get("content_id")
    for entrant in table.job.entrants:
        if seen and entrant.content_id != seen:
            said.append(
                f"The {entrant.name} network was trained on another dataset than the one whose test worlds are "
                "flown; it may have seen them."
            )
    if table.failed:
        said.append(f"{len(table.failed)} batches could not be flown; their flights are missing.")
    return said


MAIN_HEAD = (
    "map", "conventional", "proposed", "difference", "McNemar p", "paper's conventional", "paper's proposed", *BOUNDS
)  # fmt: skip


def scopes(table: Table2) -> list[tuple[str, tuple[str, ...]]]:
    """What there is a row for, and over which maps: each map, then the means."""
    found: list[tuple[str, tuple[str, ...]]] = [(map, (map,)) for map in table.maps]
    if len(table.maps) > 1:
        found.append((f"mean of all {len(table.maps)}", table.maps))
    if 1 < len(table.averaged) < len(table.maps):
        found.append((f"without {LEFT_OUT}", table.averaged))
    return found


def main_rows(table: Table2) -> list[Cells]:
    """One row per map, then the means."""
    return [_row(table, name, maps) for name, maps in scopes(table)]


def _row(table: Table2, name: str, maps: Sequence[str]) -> Cells:
    paper = [_published(name, method) if maps == (name,) else _mean(method, maps) for method in METHODS]
    conventional, proposed, *bounds = (_rate(table, pilot, maps) for pilot in (*METHODS, *BOUNDS))
    apart = p_words(table.paired(maps))
    return [name, conventional, proposed, difference(table, maps), apart, *paper, *bounds]


OTHERS_TITLE = "Other networks on the same missions"
OTHERS_HEAD = ("map", "network", "collisions", *(f"against {m}, McNemar p" for m in METHODS))
OTHERS_NOTE = (
    "Networks beyond the paper, held against both methods on the same missions: points of collision rate, p, and the "
    "missions on which only the method and only the other network collided."
)


def other_rows(table: Table2) -> list[Cells]:
    """One row per map and mean for every network beyond the two methods."""
    return [
        [name, other.name, _rate(table, other.name, maps), *(against(table, maps, m, other) for m in METHODS)]
        for name, maps in scopes(table)
        for other in table.job.others
    ]


def against(table: Table2, maps: Sequence[str], method: Method, other: Entrant) -> str:
    """``-8.0 (lower), 0.02 (31 : 14)``: another network less a method."""
    paired = table.paired(maps, method, other.name)
    return f"{difference(table, maps, method, other.name)}, {p_words(paired)}"


def _rate(table: Table2, pilot: str, maps: Sequence[str]) -> str:
    return rate_words(table.rate(pilot, maps), table.mean(pilot, maps))


def rate_words(rate: Rate, mean: float | None) -> str:
    """``12.0 % (12/100; 7.0-19.8)``; the mean over maps stands for the share where there is one."""
    if not rate.of:
        return "-"
    share = rate.share if mean is None else mean
    return f"{100 * share:.1f} % ({rate.count}/{rate.of}; {100 * rate.low:.1f}-{100 * rate.high:.1f})"


def difference(
    table: Table2, maps: Sequence[str], first: Method = METHODS[0], second: str = METHODS[1]
) -> str:
    """Second less first, in points, and whether flights tell them apart; proposed less conventional by default."""
    one, other = table.mean(first, maps), table.mean(second, maps)
    if one is None or other is None:
        return "-"
    return f"{100 * (other - one):+.1f} ({verdict(table.paired(maps, first, second))})"


def verdict(paired: Paired) -> str:
    """ "lower", "higher" or "open": what flights say about the second of two networks."""
    if paired.p >= LEVEL:
        return "open"
    return "lower" if paired.second_only < paired.first_only else "higher"


def p_words(paired: Paired) -> str:
    """``0.031 (14 : 4)``: p, and the missions on which only the first or only the second one collided."""
    return f"{paired.p:.2g} ({paired.first_only} : {paired.second_only})"


def _published(map: str, method: Method) -> str:
    row = PUBLISHED.get(map)
    if row is None:
        return "-"
    rate = row.rate(method)
    return f"{published_words(row.percent[method])} ({100 * rate.low:.1f}-{100 * rate.high:.1f})"


def _mean(method: Method, maps: Sequence[str]) -> str:
    mean = published_mean(method, maps)
    return "-" if mean is None else published_words(mean)


ENDS_HEAD = (
    "map",
    "pilot",
    "flights",
    "goal",
    "collision",
    "timeout",
    "pilot failed",
    "way gained",
    "speed",
    "hit most",
)


def end_rows(table: Table2) -> list[Cells]:
    """How flights ended; a pilot that hovers collides with nothing."""
    return [
        [
            map,
            pilot,
            str(line.flights),
            *(str(line.ends[kind].count) for kind in KINDS),
            spread_words(line.progress, 100.0, "%"),
            spread_words(line.speed_mps, 1.0, "m/s"),
            hit_words(line),
        ]
        for (map, pilot), line in table.lines.items()
    ]


def spread_words(spread: Spread, factor: float, unit: str) -> str:
    """A mean with its unit."""
    return "-" if spread.mean is None else f"{factor * spread.mean:.3g} {unit}"


def hit_words(line: Line) -> str:
    """What was touched most."""
    return ", ".join(f"{what.replace('_', ' ')} {count}" for what, count in list(line.hit.items())[:3]) or "-"


def as_markdown(table: Table2) -> str:
    """A page."""
    parts = [f"# {title(table)}", about(table), *(f"**{said}**" for said in warnings(table))]
    parts += [markdown(MAIN_HEAD, main_rows(table)), NOTE, AVERAGES]
    if table.job.others:
        parts += [f"## {OTHERS_TITLE}", markdown(OTHERS_HEAD, other_rows(table)), OTHERS_NOTE]
    parts += ["## How flights ended", markdown(ENDS_HEAD, end_rows(table))]
    return "\n\n".join(parts) + "\n"


def _network(entrant: Entrant) -> str:
    said = [entrant.architecture]
    if entrant.architecture == "pix2pix":
        said.append("an unknown w_L1" if entrant.w_l1 is None else f"w_L1 = {entrant.w_l1:g}")
    if entrant.flow != "none":
        said.append(f"{entrant.flow} flow")
    if entrant.steps is not None:
        said.append(f"{entrant.steps:,} steps")
    name = entrant.name.capitalize() if entrant.name in METHODS else entrant.name
    return f"{name}: {', '.join(said)}"
