"""Sections: where a dataset comes from, and what it cost."""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError
from scenegen.foundation.words import counted, size
from scenegen_datasets.info import DatasetInfo
from scenegen_datasets.lock import fingerprint_id
from scenegen_datasets.pages.charts import share_bar
from scenegen_datasets.pages.markup import Html, element, folded
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.report.words import cards, note
from scenegen_datasets.run_log import START
from scenegen_datasets.seal import read_bounded
from scenegen_datasets.store import RUN_LOG

_MOST_LOG_BYTES = 256 << 20

Events = Sequence[Mapping[str, Any]]


def provenance(found: DatasetInfo, lock: Mapping[str, Any]) -> Html:
    """Ids, software, recipe."""
    prints = [lock["fingerprint"], *lock["mixed_with"]]
    software = {**lock.get("software", {}), **prints[0]}
    rows = [
        ("name", found.name),
        ("version", found.version or "none while it grows"),
        ("recipe id", element("code", found.recipe_id)),
        ("content id", element("code", found.content_id or "none while it grows")),
        ("scene semantics", str(lock.get("scene_semantics", "–"))),
        ("render fingerprint", element("code", ", ".join(fingerprint_id(print_) for print_ in prints))),
        ("software", ", ".join(f"{name} {value}" for name, value in sorted(software.items()))),
        ("revision", element("code", lock.get("git_sha") or "not from a checkout")),
        ("missing clips", ", ".join(found.missing) or "none"),
    ]
    plain = canonical.pretty(lock["recipe"]).decode()
    check = note(
        "Check every byte with ",
        element("code", "scenegen verify DIR"),
        " or, without this software, with ",
        element("code", "sha256sum -c MANIFEST.sha256"),
        ".",
    )
    recipe = folded("the recipe, every default resolved", element("pre", plain))
    return Html(table((Column("", "name"), Column("")), rows) + check + recipe)


def read_log(root: Path) -> Events:
    """Events of the log, oldest first; lines that cannot be read are left out, a missing log has none."""
    try:
        lines = read_bounded(root / RUN_LOG, _MOST_LOG_BYTES).splitlines()
    except DatasetError:
        return ()
    events = []
    for line in lines:
        try:
            event = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if isinstance(event, dict) and isinstance(event.get("event"), str):
            events.append(event)
    return events


def cost(events: Events) -> Html:
    """What clips took, stage by stage."""
    clips = {
        str(e.get("clip")): e for e in events if e["event"] == "clip" and isinstance(e.get("stages"), dict)
    }
    if not clips:
        return Html(
            element("p", "The log of the run is not here: what it cost is not known.", class_="small")
        )
    wall: dict[str, float] = {}
    cpu: dict[str, float] = {}
    for event in clips.values():
        for stage, spent in event["stages"].items():
            wall[stage] = wall.get(stage, 0.0) + float(spent[0])
            cpu[stage] = cpu.get(stage, 0.0) + float(spent[1])
    total = sum(cpu.values()) or 1.0
    order = sorted(cpu, key=lambda stage: -cpu[stage])
    most = cpu[order[0]] / total
    rows = [
        (
            stage,
            f"{cpu[stage]:,.1f} s",
            f"{wall[stage]:,.1f} s",
            f"{100 * cpu[stage] / total:.0f} %",
            share_bar(cpu[stage] / total, SERIES[0], most),
        )
        for stage in order
    ]
    columns = (Column("stage", "name"), number("CPU"), number("clock"), number("share"), Column("", "wide"))
    return Html(_facts(events, list(clips.values()), total) + table(columns, rows))


def _facts(events: Events, clips: Events, cpu_s: float) -> Html:
    starts = [e for e in events if e["event"] == START]
    machine = starts[-1].get("machine", {}) if starts else {}
    peak = max((int(e.get("memory", {}).get("peak", 0)) for e in clips), default=0)
    written = sum(int(e.get("bytes", 0)) for e in clips)
    facts = [
        (f"{cpu_s / len(clips):.1f} s", "CPU a clip"),
        (_span(_clock_s(events)), f"on the clock, {counted(len(starts), 'run')}"),
        (size(written), f"written, {counted(len(clips), 'clip')}"),
        (f"{peak:,} MiB" if peak else "–", "largest worker"),
        (
            str(machine.get("cpus", "–")),
            f"CPUs; {starts[-1].get('processes', '–') if starts else '–'} at work",
        ),
    ]
    shown = [
        element(
            "div",
            element("div", figure, class_="figure"),
            element("div", words, class_="small"),
            class_="card",
        )
        for figure, words in facts
    ]
    return cards(*shown, least_px=190)


def _clock_s(events: Events) -> float:
    """From every start to the last event before the next."""
    total, begun, last = 0.0, None, None
    for event in events:
        try:
            now = datetime.datetime.fromisoformat(str(event.get("time")))
        except ValueError:
            continue
        if event["event"] == START:
            total += (last - begun).total_seconds() if begun is not None and last is not None else 0.0
            begun = now
        last = now
    return total + ((last - begun).total_seconds() if begun is not None and last is not None else 0.0)


def _span(seconds: float) -> str:
    whole = round(seconds)
    hours, rest = divmod(whole, 3600)
    return f"{hours} h {rest // 60:02d} min" if hours else f"{rest // 60} min {rest % 60:02d} s"
