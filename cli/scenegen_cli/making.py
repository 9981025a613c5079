"""What `render` and `demo` share: make a dataset with progress, verify it, say what came of it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted, size
from scenegen_cli.console import note, say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.progress import Meter
from scenegen_datasets.probe import render_fingerprint
from scenegen_datasets.render_job import Job, prepare
from scenegen_datasets.run import Outcome, run
from scenegen_datasets.store import DATASET
from scenegen_datasets.verify import Finding, VerifyReport, verify

QUARANTINED = 3
"""Exit code of a job that finished without some of its clips."""


def processes(asked: int) -> int:
    """Number of worker processes: as asked, or one per CPU this process may use.

    Raises
    ------
    InputError
        If it is not between 0 and 1024.
    """
    available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if asked == 0:
        return available
    if not 1 <= asked <= 1024:
        raise InputError(f"--jobs {asked}: ask for 1 to 1024 processes; this machine has {available}")
    return asked


def make(job: Job, again: Sequence[str], *, check_after: bool, as_json: bool) -> int:
    """Run a job and report.

    Parameters
    ----------
    job : Job
    again : sequence of str
        The command line that resumes it.
    check_after : bool
        Verify the whole dataset at the end.
    as_json : bool
        Report as one JSON document.

    Returns
    -------
    int
        Exit code.
    """
    prepare(job)
    if not as_json:
        note(f"{job.root}: {plan_in_words(job)}")
    with resumable("finished clips are kept", again), Meter(quiet=as_json) as meter:
        outcome = run(job, render_fingerprint(), meter.frames)
        report = verify(job.root, job.processes, progress=meter.verified) if check_after else None
    if as_json:
        say_json(_facts(job, outcome, report))
    else:
        say(_words(outcome, report))
        for clip, reason in outcome.quarantined:
            note(f"put aside: {clip}: {reason}")
    wrong = _unexpected(outcome, report)
    if wrong:
        note(f"verify found: {wrong[0].file}: {wrong[0].reason}")
        return 1
    return QUARANTINED if outcome.quarantined or outcome.info.missing else 0


def _unexpected(outcome: Outcome, report: VerifyReport | None) -> list[Finding]:
    """Findings beyond the clips that are known to be missing."""
    known = outcome.info.missing
    return [
        finding
        for finding in (report.findings if report is not None else ())
        if not (finding.file == DATASET and any(clip in finding.reason for clip in known))
    ]


def plan_in_words(job: Job) -> str:
    """One line: how much of what."""
    clips = job.clips
    worlds = len({(clip.map, clip.world) for clip in clips})
    camera = job.recipe.camera
    return (
        f"{counted(job.pairs, 'pair')} of {camera.width_px}x{camera.height_px} in {counted(len(clips), 'clip')} from "
        f"{counted(worlds, 'world')} ({', '.join(job.recipe.map)}), about {size(job.bytes)}, "
        f"{counted(job.processes, 'process')}"
    )


def pictures(root: Path) -> tuple[Path, Path]:
    """Where the pictures of a dataset are."""
    from scenegen_datasets.pictures.preview import FLIGHT, SHEET

    return root / SHEET, root / FLIGHT


def _words(outcome: Outcome, report: VerifyReport | None) -> str:
    info = outcome.info
    splits = ", ".join(f"{count:,} {name}" for name, count in info.splits.items() if count)
    wrong = len(_unexpected(outcome, report))
    checked = "" if report is None else f", {counted(wrong, 'finding')}" if wrong else ", verified"
    if info.missing:
        checked += f", without {len(info.missing)} of {info.clips + len(info.missing)} clips"
    return f"{info.name} {info.version}: {info.pairs:,} pairs ({splits}), {size(info.bytes)}{checked}"


def _facts(job: Job, outcome: Outcome, report: VerifyReport | None) -> dict[str, Any]:
    return {
        **asdict(outcome.info),
        "root": str(job.root),
        "made": outcome.made,
        "quarantined": dict(outcome.quarantined),
        "verified": None if report is None else report.ok,
        "findings": [] if report is None else [asdict(finding) for finding in report.findings],
    }
