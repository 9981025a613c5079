"""All audits of a dataset: one pass over a bounded, seeded sample, one result."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen_datasets.audits.contents import Contents, ContentsAudit
from scenegen_datasets.audits.draws import Draws, audit_draws
from scenegen_datasets.audits.edges import EdgeAudit, EdgeMap
from scenegen_datasets.audits.flow_quality import FlowAudit, FlowQuality
from scenegen_datasets.audits.labels import LabelAudit, LabelConsistency
from scenegen_datasets.audits.leak import DepthLeak, LeakAudit
from scenegen_datasets.audits.steps import SEED, Step, StepReader, draw_places
from scenegen_datasets.audits.verdict import Verdict
from scenegen_datasets.source import Source
from scenegen_datasets.store import read_lock

QUESTIONS: Mapping[str, str] = {
    "draws": "Was drawn what was asked for?",
    "contents": "What is to be seen?",
    "leak": "Does brightness give depth away?",
    "labels": "Do the labels agree with each other?",
    "edges": "Do heat and depth share their edges?",
    "flow": "Can flow be had from the pictures?",
}
"""Every audit and what it asks."""


@runtime_checkable
class Auditor(Protocol):
    """Looks at steps, one after the other."""

    def see(self, step: Step) -> None:
        """Take in a step."""
        ...


Watch = Callable[[int, int], None]


@dataclass(frozen=True)
class Audits:
    """Results of all audits, and how many steps of how many clips they looked at."""

    steps: int
    clips: int
    draws: Draws
    contents: Contents
    leak: DepthLeak
    labels: LabelConsistency
    edges: EdgeMap
    flow: FlowQuality

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        """The verdict of each audit."""
        return {name: getattr(self, name).verdict for name in QUESTIONS}

    @property
    def ok(self) -> bool:
        """Whether no audit found a fault."""
        return all(verdict.level != "fault" for verdict in self.verdicts.values())


def audit(root: Path, source: Source, watch: Watch | None = None) -> Audits:
    """Audit a dataset, finished or growing.

    Parameters
    ----------
    root : Path
    source : Source
        As `scenegen_datasets.source.open_source` gives it.
    watch : callable, optional
        Told how many steps are done and how many there are.

    Raises
    ------
    InputError
        If there is nothing in it yet.
    CorruptFrameError
        If stored bytes are not what was written.
    """
    places = draw_places(source)
    if not places:
        raise InputError(f"{root} holds no clip of two frames yet; let a render finish its first")
    recipe = read_lock(root)["recipe"]
    draws = audit_draws((source.facts(k) for k in range(len(source.lines))), recipe)
    contents, leak, labels = (
        ContentsAudit(_lot("contents")),
        LeakAudit(_lot("leak")),
        LabelAudit(_lot("labels")),
    )
    edges, flow = EdgeAudit(_lot("edges")), FlowAudit(_lot("flow"))
    watching: tuple[Auditor, ...] = (contents, leak, labels, edges, flow)
    for done, step in enumerate(StepReader(root, source).steps(places)):
        for one in watching:
            one.see(step)
        if watch is not None:
            watch(done + 1, len(places))
    return Audits(
        len(places),
        len({place.clip for place in places}),
        draws,
        contents.result(),
        leak.result(),
        labels.result(),
        edges.result(),
        flow.result(),
    )


def _lot(name: str) -> np.random.Generator:
    """Every audit draws its pixels from a lot of its own."""
    return stream(SEED, "audit", name)


def as_json(audits: Audits) -> dict[str, Any]:
    """Plain data for machines; numbers that do not exist are null."""
    plain: dict[str, Any] = _finite(asdict(audits))
    return {"ok": audits.ok, **plain}


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(child) for key, child in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(child) for child in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
