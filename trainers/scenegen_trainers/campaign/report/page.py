"""``index.html``: what came of a campaign, on one page that needs no other file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from scenegen.foundation import canonical
from scenegen.foundation.atomic import write_atomic
from scenegen_trainers.campaign.report import style
from scenegen_trainers.campaign.report.charts import Mark, ends_bar, rate_bar, share_bar, sweep_chart
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS, PILOT_COLOUR, interval, percent, text
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
    sections = [
        f"<h1>{text(title)}</h1><p class=lead>{text(_lead(campaign))}</p>",
        *(_sweeps(campaign, results) if campaign.swept else []),
        _table(results.lines, campaign),
        *([_duels(results.duels, campaign.swept)] if results.duels else []),
        *_plans(campaign, results),
        _hits(results.lines, campaign.swept),
        _failed_flights(campaign, results),
        _recipe(campaign),
    ]
    return (
        "<!doctype html><html lang=en><head><meta charset=utf-8>"
        '<meta name=viewport content="width=device-width,initial-scale=1">'
        f"<title>{text(title)}</title><style>{style.SHEET}</style></head><body><main>"
        f"{''.join(sections)}</main><script>{style.SCRIPT}</script></body></html>\n"
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


def _table(lines: Sequence[Line], campaign: Campaign) -> str:
    """One row per point, map and pilot."""
    names = list(labels(campaign))
    point = "<th>point</th>" if campaign.swept else ""
    head = (
        f"<tr>{point}<th>map</th><th>pilot</th><th>collision rate</th><th>95 % interval</th><th>how flights ended"
        "</th><th class=number>flights</th><th class=number>progress</th><th class=number>speed</th>"
        "<th class=number>closest pass</th><th class=number>latency</th></tr>"
    )
    rows = []
    for line in lines:
        colour = PILOT_COLOUR[names.index(line.pilot) % len(PILOT_COLOUR)]
        first = f"<td>{text(line.point)}</td>" if campaign.swept else ""
        rows.append(
            f"<tr>{first}<td>{text(line.map)}</td><td>{text(line.pilot)}</td>"
            f"<td class=big>{percent(line.collision)}<br><span class=small>{line.collision.count} of "
            f"{line.collision.of}</span></td><td>{rate_bar(line.collision, colour)}"
            f"<span class=small>{interval(line.collision)}</span></td>"
            f"<td>{ends_bar(line.ends)}<span class=small>{_ends(line)}</span></td>"
            f"<td class=number>{line.flights}</td><td class=number>{_mean(line.progress, 100, ' %')}</td>"
            f"<td class=number>{_mean(line.speed_mps, 1, ' m/s')}</td>"
            f"<td class=number>{_median(line.closest_m)}</td>"
            f"<td class=number>{_mean(line.latency_ms, 1, ' ms')}</td></tr>"
        )
    return f"<h2>Figures</h2><table>{head}{''.join(rows)}</table>"


def _ends(line: Line) -> str:
    return ", ".join(f"{rate.count} {END_WORDS[kind]}" for kind, rate in line.ends.items() if rate.count)


def _mean(spread: Spread, factor: float, unit: str) -> str:
    return "-" if spread.mean is None else f"{factor * spread.mean:.3g}{unit}"


def _median(spread: Spread) -> str:
    if spread.median is None:
        return "-"
    return (
        f'<span title="10 to 90 % of flights: {spread.low} to {spread.high} m">{spread.median:.2f} m</span>'
    )


def _duels(duels: Sequence[Duel], swept: bool) -> str:
    point = "<th>point</th>" if swept else ""
    rows = []
    for duel in duels:
        first = f"<td>{text(duel.point)}</td>" if swept else ""
        pair = duel.paired
        rows.append(
            f"<tr>{first}<td>{text(duel.map)}</td><td class=number>{pair.both}</td>"
            f"<td class=number>{pair.first_only}</td><td class=number>{pair.second_only}</td>"
            f"<td class=number>{pair.neither}</td><td class=number>{pair.p:.2g}</td></tr>"
        )
    names = text(duels[0].first), text(duels[0].second)
    head = (
        f"<tr>{point}<th>map</th><th class=number>both collided</th><th class=number>only {names[0]}</th>"
        f"<th class=number>only {names[1]}</th><th class=number>neither</th>"
        "<th class=number>McNemar's exact p</th></tr>"
    )
    return f"<h2>Mission by mission</h2><table>{head}{''.join(rows)}</table>"


def _sweeps(campaign: Campaign, results: Results) -> Iterator[str]:
    """A chart for each axis and map."""
    by_key = {(line.point, line.map, line.pilot): line.collision for line in results.lines}
    axes: dict[str, list[Point]] = {}
    for point in campaign.sweep:
        axes.setdefault(point.axis, []).append(point)
    yield "<h2>Collision rate</h2><div class=cards>"
    for points in axes.values():
        marks = [Mark(point.value, point.number) for point in points]
        for map in campaign.recipe.dataset.map:
            series = {
                pilot: [by_key[point.name, map, pilot] for point in points] for pilot in labels(campaign)
            }
            yield f"<div class=card><h3>{text(map)}</h3>{sweep_chart(points[0].words, marks, series)}</div>"
    yield "</div>"


def _plans(campaign: Campaign, results: Results) -> Iterator[str]:
    """The map of each world with every pilot's flights over it."""
    store = CampaignStore(campaign.root)
    definitions: list[str] = []
    cards: list[str] = []
    for (point, map, pilot), found in results.flown.items():
        if point != BASE_POINT:
            continue
        for world in sorted({record.world for _, record in found}):
            plan = store.read_plan(map, world)
            if plan is None:
                continue
            name = f"{map}-{world}"
            if not any(f'id="{name}"' in definition for definition in definitions):
                definitions.append(picture_definition(name, plan[0]))
            frame = Frame(tuple(plan[1]["centre_m"]), plan[1]["height_m"], plan[1]["focal_px"])
            batches = [record for _, record in found if record.world == world]
            flights = [flight for record in batches for flight in record.flights]
            hours = ", ".join(f"{record.hour:.1f}" for record in batches)
            cards.append(
                f"<div class=card><h3>{text(map)} {world} · {text(pilot)} <span class=small>{len(flights)} flights "
                f"at {hours} h</span></h3>{plan_svg(name, frame, flights)}</div>"
            )
    if cards:
        boxes = "".join(
            f'<label><input type=checkbox checked value={kind}><i style="background:{END_COLOUR[kind]}"></i>'
            f"{END_WORDS[kind]}</label>"
            for kind in KINDS
        )
        yield f'<svg width=0 height=0 style="position:absolute"><defs>{"".join(definitions)}</defs></svg>'
        yield f"<h2>Where they flew</h2><div class=key>{boxes}<span>● start &nbsp;○ goal &nbsp;✕ crash</span></div>"
        yield f"<div class=cards>{''.join(cards)}</div>"


def _hits(lines: Sequence[Line], swept: bool) -> str:
    """What was touched, by class."""
    rows = []
    for line in lines:
        where = f"{line.map} {line.point}" if swept else line.map
        all_ = max(sum(line.hit.values()), 1)
        for what, count in line.hit.items():
            rows.append(
                f"<tr><td>{text(where)}</td><td>{text(line.pilot)}</td><td>{text(what.replace('_', ' '))}</td>"
                f"<td class=number>{count}</td>"
                f"<td class=wide>{share_bar(count / all_, END_COLOUR['collision'])}</td></tr>"
            )
    if not rows:
        return ""
    head = "<tr><th>map</th><th>pilot</th><th>class</th><th class=number>collisions</th><th></th></tr>"
    return f"<h2>What was hit</h2><table>{head}{''.join(rows)}</table>"


def _failed_flights(campaign: Campaign, results: Results) -> str:
    """Every flight that did not reach its goal, as far as they fit."""
    rows = []
    for (point, map, pilot), found in results.flown.items():
        for _, record in found:
            for flight in record.flights:
                if flight.kind != "goal":
                    what = flight.what.replace("_", " ") or flight.reason
                    rows.append(
                        f"<tr><td>{text(map)}</td><td>{text(pilot)}</td><td>{text(point)}</td>"
                        f"<td class=number>{flight.flight}</td><td class=number>{record.hour:.1f}</td>"
                        f"<td style='color:{END_COLOUR[flight.kind]}'>{END_WORDS[flight.kind]}</td>"
                        f"<td>{text(what)}</td>"
                        f"<td class=number>{flight.time_s:.1f} s</td>"
                        f"<td class=number>{100 * flight.progress:.0f} %</td></tr>"
                    )
    if not rows:
        return ""
    more = (
        f"<p class=small>and {len(rows) - _MOST_ROWS} more, see flights.csv</p>"
        if len(rows) > _MOST_ROWS
        else ""
    )
    head = (
        "<tr><th>map</th><th>pilot</th><th>point</th><th class=number>flight</th><th class=number>hour</th>"
        "<th>end</th><th>what</th><th class=number>after</th><th class=number>way gained</th></tr>"
    )
    return (
        f"<h2>Flights that did not arrive</h2><details><summary>{len(rows)} flights; see one again with "
        f"<code>--replay FLIGHT</code></summary><table>{head}{''.join(rows[:_MOST_ROWS])}</table>{more}</details>"
    )


def _recipe(campaign: Campaign) -> str:
    plain = text(canonical.pretty(campaign.recipe.canonical()).decode())
    words = "everything that decided these flights, but for the pilots"
    return f"<h2>Recipe</h2><details><summary>{words}</summary><pre>{plain}</pre></details>"
