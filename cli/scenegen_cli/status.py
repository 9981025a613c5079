"""``scenegen status``: how far a dataset is, while it is being made or after something stopped it."""

from __future__ import annotations

import os
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from scenegen.foundation.canonical import parse as parse_json
from scenegen.foundation.errors import DatasetError
from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse

_TAIL_BYTES = 1 << 20
_MOST_HOLDER_BYTES = 4096


@dataclass(frozen=True)
class Status:
    """Say how far a dataset is, who writes it, and what went wrong so far."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Status, "status", arguments)
    facts = _facts(command.dataset)
    if command.json:
        say_json(facts)
        return 0
    rows = [
        ("pairs", f"{facts['pairs']:,} of {facts['pairs_planned']:,} ({100 * facts['share']:.0f} %)"),
        ("state", facts["state"]),
        ("writer", facts["writer"] or "none"),
        ("last event", facts["last_event"] or "none"),
    ]
    rows += [("put aside", f"{clip}: {reason}") for clip, reason in facts["quarantined"].items()]
    say(table(rows))
    return 0


def _facts(root: Path) -> dict[str, Any]:
    from scenegen_datasets.info import info
    from scenegen_datasets.store import finished

    found = info(root)
    done = finished(root)
    events = _events(root)
    start = max((k for k, event in enumerate(events) if event.get("event") == "start"), default=0)
    quarantined = {e["clip"]: e["message"] for e in events[start:] if e.get("event") == "quarantine"}
    planned = found.pairs_planned or found.pairs
    writer = writer_of(root)
    state = (
        "complete"
        if found.complete
        else "being made"
        if writer
        else "stopped; run the same render command again"
    )
    return {
        "pairs": found.pairs,
        "pairs_planned": planned,
        "share": found.pairs / max(planned, 1),
        "clips": len(done),
        "state": state,
        "writer": writer,
        "last_event": f"{events[-1]['time']} {events[-1]['event']}" if events else None,
        "quarantined": {clip: reason for clip, reason in quarantined.items() if clip not in done},
    }


def _events(root: Path) -> list[dict[str, Any]]:
    """The run log's last events; a torn or foreign line is left out."""
    from scenegen_datasets.inside import open_inside
    from scenegen_datasets.store import RUN_LOG

    try:
        with os.fdopen(open_inside(root, RUN_LOG), "rb") as file:
            file.seek(max(0, os.fstat(file.fileno()).st_size - _TAIL_BYTES))
            lines = file.read(_TAIL_BYTES).split(b"\n")
    except (DatasetError, OSError):
        return []
    return [event for line in lines if (event := _event(line)) is not None]


def _event(line: bytes) -> dict[str, Any] | None:
    try:
        event = parse_json(line, "event")
    except DatasetError:
        return None
    names = ("time", "event", *(("clip", "message") if b'"quarantine"' in line else ()))
    sound = isinstance(event, dict) and all(isinstance(event.get(name), str) for name in names)
    return event if sound else None


def writer_of(root: Path) -> str | None:
    """Who holds the directory's lock; a dead process of this host does not count."""
    from scenegen_datasets.inside import read_inside
    from scenegen_datasets.store import WRITER_LOCK

    try:
        holder = parse_json(read_inside(root, WRITER_LOCK, _MOST_HOLDER_BYTES), WRITER_LOCK)
        pid, host = int(holder["pid"]), str(holder["host"])
    except (DatasetError, ValueError, KeyError, TypeError, OverflowError):
        return None
    if host == socket.gethostname():
        try:
            os.kill(pid, 0)
        except (ProcessLookupError, OverflowError):
            return None
        except PermissionError:
            pass
    return f"process {pid} on {host}"
