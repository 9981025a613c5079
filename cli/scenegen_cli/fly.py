"""``scenegen fly``: many flights of one or two pilots, and what came of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted
from scenegen_cli.asking import sources
from scenegen_cli.console import note, say, say_json
from scenegen_cli.helping import keys_help
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse, split_recipe_flags
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.resolve import Source, leaves

if TYPE_CHECKING:
    from scenegen_trainers.campaign.run import Campaign

_MOST_FLIGHTS = 1_000_000

PUT_ASIDE = 3
"""Exit code of a campaign that finished without some of its batches."""


@dataclass(frozen=True)
class Fly:
    """Fly missions in closed loop and count collisions. Run again to resume; raise --flights to fly more.

    Takes all recipe keys as flags as well, such as --map, --seed, --climate.date and --loop.radius-m.
    """

    flights: int = 100
    """Missions of each map, the same for every pilot."""
    pilot: str = "oracle"
    """Who flies: oracle (true depth), blind, a depth network (.pt, .onnx), or module:attribute."""
    versus: str | None = None
    """A second pilot on the same missions, compared flight by flight."""
    planner: str = "waypoint"
    """Turns depth into velocities: waypoint, five_section, straight, or module:attribute."""
    hours: tuple[float, ...] = ()
    """Hours of the day; batches take turns at several. By default every batch has one of its own."""
    netd: float | None = None
    """NETD of the thermal camera [mK]; short for --sensor.netd-mk."""
    speed: float | None = None
    """Cruise speed [m/s]; short for --loop.cruise-mps."""
    difficulty: float | None = None
    """Share of missions whose straight way is obstructed; short for --mission.difficulty."""
    latency: str | None = None
    """From frame to command: milliseconds, or 'measured' for what the pilot takes on this machine."""
    sweep: tuple[str, ...] = ()
    """KEY=VALUE,VALUE: fly all missions at each value of speed, hour, netd, weather, ... or of a recipe key."""
    replay: tuple[int, ...] = ()
    """Flights to fly once more and keep as animations: thermal, believed depth, true depth."""
    out: Path | None = None
    """Directory of the campaign; by default flights-MAP here."""
    recipe: Path | None = None
    """YAML file of recipe keys; flags win over it."""
    size: str | None = None
    """Image size WIDTHxHEIGHT; keeps the camera's horizontal field of view."""
    jobs: int = 0
    """Worker processes; 0 is one per CPU."""
    allow_mixed: bool = False
    """Go on with a campaign that other software versions began."""
    dry_run: bool = False
    """Say what would be flown, and stop."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    from scenegen_trainers.campaign.recipe import flight_keys

    keys = [key for key, _, _ in (*leaves(Recipe), *flight_keys())]
    own, flags = split_recipe_flags(arguments, keys)
    command = parse(Fly, "fly", own, _recipe_help())
    campaign = ask(command, flags)
    again = ["scenegen", "fly", *arguments, *([] if command.out else ["--out", str(campaign.root)])]
    if command.dry_run:
        return _say_plan(campaign, command.json)
    return _fly(campaign, command, again)


def ask(command: Fly, flags: Mapping[str, Any]) -> Campaign:
    """The campaign a command line asks for.

    Parameters
    ----------
    command : Fly
    flags : mapping
        Recipe keys from the command line, nested.

    Raises
    ------
    InputError
        For whatever is wrong with it, before anything is built.
    """
    from scenegen.maps.own_scene.own_scene import describe
    from scenegen_cli.making import processes
    from scenegen_flythrough.planners.registry import planner
    from scenegen_trainers.campaign.recipe import resolve_flights
    from scenegen_trainers.campaign.run import Campaign
    from scenegen_trainers.campaign.store import BASE_POINT
    from scenegen_trainers.campaign.sweep import parse_sweep
    from scenegen_trainers.campaign.worker import check_pilot
    from scenegen_trainers.pilots.modules import find_modules_here
    from scenegen_trainers.pilots.spec import parse_pilot

    if not 1 <= command.flights <= _MOST_FLIGHTS:
        raise InputError(f"--flights {command.flights}: ask for 1 to {_MOST_FLIGHTS:,}")
    asked = _sources(command, flags)
    recipe = resolve_flights(asked)
    for scene in recipe.dataset.scenes.values():
        describe(scene)
    sweep = parse_sweep(command.sweep)
    points = {
        point.name: resolve_flights([*asked, Source(f"--sweep {point.axis}={point.value}", point.keys)])
        for point in sweep
    }
    find_modules_here()
    planner(command.planner, recipe.loop)
    words = [command.pilot, *([command.versus] if command.versus is not None else [])]
    pilots = tuple(parse_pilot(word, command.planner) for word in words)
    if len(set(pilots)) < len(pilots):
        raise InputError(f"--versus {command.versus}: is the pilot itself; name another")
    for spec in pilots:
        check_pilot(spec, recipe)
    wrong = [k for k in command.replay if not 0 <= k < command.flights]
    if wrong:
        raise InputError(f"--replay {wrong[0]}: this campaign has flights 0 to {command.flights - 1}")
    root = command.out or Path("-".join(("flights", *recipe.dataset.map)))
    return Campaign(
        recipe=recipe,
        points=points or {BASE_POINT: recipe},
        pilots=pilots,
        flights=command.flights,
        root=root,
        processes=processes(command.jobs),
        sweep=sweep,
        allow_mixed=command.allow_mixed,
    )


def _sources(command: Fly, flags: Mapping[str, Any]) -> list[Source]:
    """What was asked for, from the weakest to the strongest."""
    short = [
        Source(flag, {section: {key: value}})
        for flag, value, section, key in (
            ("--hours", command.hours or None, "campaign", "hours"),
            ("--netd", command.netd, "sensor", "netd_mk"),
            ("--speed", command.speed, "loop", "cruise_mps"),
            ("--difficulty", command.difficulty, "mission", "difficulty"),
        )
        if value is not None
    ]
    if command.latency is not None:
        short.append(Source(f"--latency {command.latency}", {"loop": _latency(command.latency)}))
    return sources(command.recipe, flags, command.size, short)


def _latency(text: str) -> dict[str, Any]:
    if text == "measured":
        return {"latency": "measured"}
    try:
        return {"latency": "fixed", "latency_ms": float(text)}
    except ValueError:
        raise InputError(f"--latency {text}: give milliseconds, or 'measured'") from None


def _say_plan(campaign: Campaign, as_json: bool) -> int:
    if as_json:
        say_json(
            {
                "root": str(campaign.root),
                "flights": campaign.total,
                "points": list(campaign.points),
                "batches": {
                    map: [{"world": b.world, "flights": b.count} for b in plan]
                    for map, plan in campaign.plans.items()
                },
                "recipe": campaign.recipe.canonical(),
            }
        )
    else:
        say(f"{campaign.root}: {_plan_in_words(campaign)}")
    return 0


def _plan_in_words(campaign: Campaign) -> str:
    worlds = sum(len({batch.world for batch in plan}) for plan in campaign.plans.values())
    camera = campaign.recipe.dataset.camera
    swept = f" at {len(campaign.points)} points" if campaign.swept else ""
    return (
        f"{counted(campaign.total, 'flight')} of {', '.join(spec.name for spec in campaign.pilots)}{swept} through "
        f"{counted(worlds, 'world')} ({', '.join(campaign.recipe.dataset.map)}), "
        f"{camera.width_px}x{camera.height_px}, {counted(campaign.processes, 'process')}"
    )


def _fly(campaign: Campaign, command: Fly, again: Sequence[str]) -> int:
    from scenegen_cli.flown import in_words
    from scenegen_cli.flying import fly_meter
    from scenegen_trainers.campaign.replay import replay
    from scenegen_trainers.campaign.report.page import write_page
    from scenegen_trainers.campaign.results import gather, to_json, write
    from scenegen_trainers.campaign.run import run as fly

    if not command.json:
        note(f"{campaign.root}: {_plan_in_words(campaign)}")
    with resumable("finished batches are kept", again), fly_meter(quiet=command.json) as told:
        failed = fly(campaign, told)
        results = gather(campaign)
        files = [*write(campaign, results), write_page(campaign, results)]
        for flight in command.replay:
            files += replay(campaign, flight)
    if command.json:
        say_json({**to_json(campaign, results), "failed": failed, "files": [str(file) for file in files]})
    else:
        say(in_words(campaign, results))
        say("\n".join(f"{file}" for file in files))
    for batch, reason in failed.items():
        note(f"put aside: {batch}: {reason}")
    return PUT_ASIDE if failed else 0


def _recipe_help() -> str:
    """Recipe keys of the closed loop; those of the dataset are `scenegen render`'s."""
    from scenegen_trainers.campaign.recipe import flight_keys

    keys = keys_help("recipe keys of the closed loop, as flags here or in a YAML file:", flight_keys())
    return f"\n\n{keys}\n\nthose of worlds, weather and camera: scenegen render --help"
