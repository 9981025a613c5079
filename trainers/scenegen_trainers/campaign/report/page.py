"""``index.html``: what came of a campaign, on one page that needs no other file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from scenegen.foundation import canonical
from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.words import counted
from scenegen_datasets.pages.charts import key, share_bar
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element, folded, join, text
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.pictures.words import clock
from scenegen_trainers.campaign.record import BatchRecord
from scenegen_trainers.campaign.report import style
from scenegen_trainers.campaign.report.charts import Mark, ends_bar, rate_bar, sweep_chart
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS, PILOT_COLOUR, interval, percent
from scenegen_trainers.campaign.report.plan_svg import picture_definition, plan_svg
from scenegen_trainers.campaign.report.plan_view import Frame
from scenegen_trainers.campaign.results import Results, labels
from scenegen_trainers.campaign.run import Campaign
from scenegen_trainers.campaign.store import BASE_POINT, PAGE, CampaignStore
from scenegen_trainers.campaign.summary import KINDS, Duel, Line, Spread
from scenegen_trainers.campaign.sweep import Point

_MOST_ROWS = 400


def write_page(campaign: Campaign, results: Results) -> Path:
    """Write the page of a campaign; returns its path."""
    path = campaign.root / PAGE
    write_atomic(path, page(campaign, results).encode())
    return path


def page(campaign: Campaign, results: Results) -> str:
    """The page as HTML."""
    title = f"{', '.join(labels(campaign))} over {', '.join(campaign.recipe.dataset.map)}"
    return document(
        title,
        element("h1", title),
        element("p", _lead(campaign), class_="lead"),
        *(_sweeps(campaign, results) if campaign.swept else []),
        _figures(results.lines, campaign),
        *([_duels(results.duels, campaign.swept)] if results.duels else []),
        *_plans(campaign, results),
        _hits(results.lines, campaign.swept),
        _failed_flights(campaign, results),
        _recipe(campaign),
        sheet=style.SHEET,
        script=style.SCRIPT,
    )


def _lead(campaign: Campaign) -> str:
    recipe = campaign.recipe
    camera, loop = recipe.dataset.camera, recipe.loop
    late = "measured latency" if loop.latency == "measured" else f"{loop.latency_ms:g} ms latency"
    planners = ", ".join(dict.fromkeys(spec.planner for spec in campaign.pilots))
    return (
        f"{campaign.flights:,} missions per map, the same for every pilot · planner {planners} · "
        f"cruise {loop.cruise_mps:g} m/s · {late} · camera {camera.width_px}×{camera.height_px}, "
        f"{camera.hfov_deg:g}° · NETD {recipe.dataset.sensor.netd_mk:g} mK · seed {recipe.dataset.seed}"
    )


def _figures(lines: Sequence[Line], campaign: Campaign) -> Html:
    """One row per point, map and pilot."""
    names = list(labels(campaign))
    columns = (
        Column("map", "name"),
        Column("pilot", "name"),
        Column("collision rate", "big"),
        Column("95 % interval"),
        Column("how flights ended"),
        *map(number, ("flights", "progress", "speed", "closest pass", "latency")),
    )
    rows = [_row(line, PILOT_COLOUR[names.index(line.pilot) % len(PILOT_COLOUR)]) for line in lines]
    if campaign.swept:
        columns = (Column("point", "name"), *columns)
        rows = [(line.point, *row) for line, row in zip(lines, rows, strict=True)]
    return join([element("h2", "Figures"), table(columns, rows)])


def _row(line: Line, colour: str) -> tuple[object, ...]:
    counts = element("div", f"{line.collision.count} of {line.collision.of}", class_="small")
    return (
        line.map,
        line.pilot,
        join([percent(line.collision), counts]),
        join([rate_bar(line.collision, colour), element("span", interval(line.collision), class_="small")]),
        join([ends_bar(line.ends), element("span", _ends(line), class_="small")]),
        line.flights,
        _mean(line.progress, 100, " %"),
        _mean(line.speed_mps, 1, " m/s"),
        _median(line.closest_m),
        _mean(line.latency_ms, 1, " ms"),
    )


def _ends(line: Line) -> str:
    return ", ".join(f"{rate.count} {END_WORDS[kind]}" for kind, rate in line.ends.items() if rate.count)


def _mean(spread: Spread, factor: float, unit: str) -> str:
    return "-" if spread.mean is None else f"{factor * spread.mean:.3g}{unit}"


def _median(spread: Spread) -> Html:
    if spread.median is None:
        return text("-")
    return element(
        "span", f"{spread.median:.2f} m", title=f"10 to 90 % of flights: {spread.low} to {spread.high} m"
    )


def _duels(duels: Sequence[Duel], swept: bool) -> Html:
    first, second = duels[0].first, duels[0].second
    columns: tuple[Column, ...] = (
        Column("map", "name"),
        *map(number, ("both collided", f"only {first}", f"only {second}", "neither", "McNemar's exact p")),
    )
    rows: list[tuple[object, ...]] = [
        (
            duel.map,
            duel.paired.both,
            duel.paired.first_only,
            duel.paired.second_only,
            duel.paired.neither,
            f"{duel.paired.p:.2g}",
        )
        for duel in duels
    ]
    if swept:
        columns = (Column("point", "name"), *columns)
        rows = [(duel.point, *row) for duel, row in zip(duels, rows, strict=True)]
    return join([element("h2", "Mission by mission"), table(columns, rows)])


def _sweeps(campaign: Campaign, results: Results) -> Iterator[Html]:
    """A chart for each axis and map."""
    by_key = {(line.point, line.map, line.pilot): line.collision for line in results.lines}
    axes: dict[str, list[Point]] = {}
    for point in campaign.sweep:
        axes.setdefault(point.axis, []).append(point)
    names = labels(campaign)
    yield element("h2", "Collision rate")
    yield key(list(zip(PILOT_COLOUR, names, strict=False))) if len(names) > 1 else text("")
    cards = []
    for points in axes.values():
        marks = [Mark(point.value, point.number) for point in points]
        for map in campaign.recipe.dataset.map:
            series = {pilot: [by_key[point.name, map, pilot] for point in points] for pilot in names}
            cards.append(_card(element("h3", map), sweep_chart(points[0].words, marks, series)))
    yield _cards(cards)


def _card(*content: Html) -> Html:
    return element("div", *content, class_="card")


def _cards(content: Sequence[Html]) -> Html:
    return element("div", *content, class_="cards", style="--least:480px")


def _plans(campaign: Campaign, results: Results) -> Iterator[Html]:
    """The map of each world with every pilot's flights over it, one pilot beside the other."""
    store = CampaignStore(campaign.root)
    definitions: list[str] = []
    cards: dict[tuple[str, int], list[Html]] = {}
    for (point, map, pilot), found in results.flown.items():
        if point != BASE_POINT:
            continue
        for world in sorted({record.world for _, record in found}):
            plan = store.read_plan(map, world)
            if plan is None:
                continue
            name = f"{map}-{world}"
            if (map, world) not in cards:
                definitions.append(picture_definition(name, plan[0]))
            frame = Frame(tuple(plan[1]["centre_m"]), plan[1]["height_m"], plan[1]["focal_px"])
            batches = [record for _, record in found if record.world == world]
            flights = [flight for record in batches for flight in record.flights]
            head = element("h3", f"{map} {world} · {pilot} ", _flown_when(batches, len(flights)))
            cards.setdefault((map, world), []).append(_card(head, plan_svg(name, frame, flights)))
    if cards:
        yield Html(f'<svg class="shelf" aria-hidden="true"><defs>{"".join(definitions)}</defs></svg>')
        yield element("h2", "Where they flew")
        yield _kinds()
        yield _cards([card for of_world in cards.values() for card in of_world])


def _flown_when(batches: Sequence[BatchRecord], flights: int) -> Html:
    hours = ", ".join(clock(record.hour) for record in batches)
    return element("span", f"{counted(flights, 'flight')} at {hours} solar time", class_="small")


def _kinds() -> Html:
    """What the colours mean, and a switch for each."""
    boxes = "".join(
        f'<label><input type="checkbox" checked value="{kind}"><i style="background:{END_COLOUR[kind]}"></i>'
        f"{text(END_WORDS[kind])}</label>"
        for kind in KINDS
    )
    marks = " &nbsp;".join(("● start", "○ goal", "✕ crash", "■ another end", "┄ way that was left"))
    return Html(f'<div class="key">{boxes}<span>{marks}</span></div>')


def _hits(lines: Sequence[Line], swept: bool) -> Html:
    """What was touched, by class."""
    rows = [
        (
            f"{line.map} {line.point}" if swept else line.map,
            line.pilot,
            what.replace("_", " "),
            count,
            share_bar(count / max(sum(line.hit.values()), 1), END_COLOUR["collision"]),
        )
        for line in lines
        for what, count in line.hit.items()
    ]
    columns = ("map", "pilot", "class", number("collisions"), Column("", "wide"))
    return join([element("h2", "What was hit"), table(columns, rows)]) if rows else text("")


def _failed_flights(campaign: Campaign, results: Results) -> Html:
    """Every flight that did not reach its goal, as far as they fit."""
    rows = [
        (
            map,
            pilot,
            point,
            flight.flight,
            clock(record.hour),
            element("span", END_WORDS[flight.kind], style=f"color:{END_COLOUR[flight.kind]}"),
            flight.what.replace("_", " ") or flight.reason,
            f"{flight.time_s:.1f} s",
            f"{100 * flight.progress:.0f} %",
        )
        for (point, map, pilot), found in results.flown.items()
        for _, record in found
        for flight in record.flights
        if flight.kind != "goal"
    ]
    if not rows:
        return text("")
    more = f"and {len(rows) - _MOST_ROWS} more, see flights.csv" if len(rows) > _MOST_ROWS else ""
    columns = (
        "map",
        "pilot",
        "point",
        number("flight"),
        number("hour"),
        "end",
        "what",
        number("after"),
        number("way gained"),
    )
    words = join([f"{len(rows)} flights; see one again with ", element("code", "--replay FLIGHT")])
    shown = table(columns, rows[:_MOST_ROWS])
    return join(
        [
            element("h2", "Flights that did not arrive"),
            folded(words, shown, element("p", more, class_="small")),
        ]
    )


def _recipe(campaign: Campaign) -> Html:
    plain = canonical.pretty(campaign.recipe.canonical()).decode()
    words = "everything that decided these flights, but for the pilots"
    return join([element("h2", "Recipe"), folded(words, element("pre", plain))])
