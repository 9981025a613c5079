"""``scenegen status``: how far a dataset is, while it is being made or after something stopped it."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import HelpShown, parse

_TAIL_BYTES = 1 << 20


@dataclass(frozen=True)
class Status:
    """Say how far a dataset is, who writes it, and what went wrong so far."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    try:
        command = parse(Status, "status", arguments)
    except HelpShown:
        return 0
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
    writer = _writer(root)
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
    from scenegen_datasets.store import RUN_LOG

    path = root / RUN_LOG
    if not path.is_file():
        return []
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _TAIL_BYTES))
        lines = file.read().decode("utf-8", "replace").splitlines()
    events = []
    for line in lines:
        try:
            event = json.loads(line)
        except ValueError:
            continue
        if isinstance(event, dict) and {"time", "event"} <= event.keys():
            events.append(event)
    return events


def _writer(root: Path) -> str | None:
    """Who holds the directory's lock; a dead process of this host does not count."""
    from scenegen_datasets.store import WRITER_LOCK

    try:
        holder = json.loads((root / WRITER_LOCK).read_bytes()[:4096])
        pid, host = int(holder["pid"]), str(holder["host"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if host == socket.gethostname():
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return None
        except PermissionError:
            pass
    return f"process {pid} on {host}"
