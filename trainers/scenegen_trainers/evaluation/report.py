"""An evaluation on disk: a page and Markdown for people, JSON for machines, sheets of the best and worst answers."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_datasets.place import make_directory
from scenegen_trainers.evaluation import words
from scenegen_trainers.evaluation.answers import Answer, answers
from scenegen_trainers.evaluation.evaluate import Evaluation, Judged
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE, Standing, Standings
from scenegen_trainers.evaluation.page import page
from scenegen_trainers.evaluation.pictures import answer_sheet
from scenegen_trainers.evaluation.scores import NAMES, head_of, markdown, named
from scenegen_trainers.metrics import DepthReport
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.training.samples import Samples
from scenegen_trainers.training.source import TrainingData

SHOWN = 6
"""Answers on a sheet."""


def write_report(
    evaluation: Evaluation, checkpoint: Checkpoint, data: TrainingData, out: Path
) -> tuple[Path, ...]:
    """Write ``evaluation.html``, ``.md`` and ``.json``, ``best.png`` and ``worst.png``; returns their paths.

    Parameters
    ----------
    evaluation : Evaluation
    checkpoint : Checkpoint
    data : TrainingData
        What was judged on what.
    out : Path
        Directory, which is made.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    make_directory(out)
    ranked = sorted(evaluation.images, key=lambda image: (image.scores.rel, image.key))
    best, worst = (
        _answered(_one_per_clip(some), evaluation, checkpoint, data) for some in (ranked, ranked[::-1])
    )
    files = {
        "evaluation.html": page(evaluation, best, worst).encode(),
        "evaluation.md": as_markdown(evaluation).encode(),
        "evaluation.json": pretty(as_json(evaluation)),
        "best.png": _sheet("Best answers", best, evaluation),
        "worst.png": _sheet("Worst answers", worst, evaluation),
    }
    for name, content in files.items():
        write_atomic(out / name, content)
    return tuple(out / name for name in files)


def as_json(evaluation: Evaluation) -> dict[str, Any]:
    """Plain data, every digit."""
    return {
        "model": dict(evaluation.record),
        "dataset": dict(evaluation.dataset),
        "split": evaluation.split,
        "scores": report_json(evaluation.report),
        "painted": report_json(evaluation.painted),
        "interval_95": _spans(evaluation.network[WHOLE]),
        "strata": _strata_json(evaluation.network),
        "baselines": {
            name: {
                **report_json(standings[WHOLE].report),
                "painted": report_json(standings[PAINTED].report),
                "interval_95": _spans(standings[WHOLE]),
                "strata": _strata_json(standings),
            }
            for name, standings in evaluation.baselines.items()
        },
        "better_by_95": {
            name: {
                stratum: {s: list(span) for s, span in spans.items()} for stratum, spans in margins.items()
            }
            for name, margins in evaluation.margins.items()
        },
    }


def report_json(report: DepthReport) -> dict[str, Any]:
    """A `DepthReport` as plain data."""
    return {
        "pooled": named(report.pooled),
        "per_image": named(report.per_image),
        "pooled_aligned": named(report.pooled_aligned),
        "per_image_aligned": named(report.per_image_aligned),
        "by_range": [
            {
                "from_m": low,
                "below_m": high if high != float("inf") else None,
                "scores": named(scores) if scores else None,
            }
            for low, high, scores in report.by_range
        ],
        "images": report.images,
        "skipped": report.skipped,
        "pixels": report.pixels,
        "missing": report.missing,
    }


def _strata_json(standings: Standings) -> dict[str, Any]:
    return {
        name: {**report_json(standing.report), "interval_95": _spans(standing)}
        for name, standing in standings.items()
        if name not in (WHOLE, PAINTED)
    }


def _spans(standing: Standing) -> dict[str, list[float]]:
    return {name: list(span) for name, span in standing.interval.items()}


def as_markdown(evaluation: Evaluation) -> str:
    """A page."""
    whole = evaluation.network[WHOLE]
    parts = [f"# {words.title(evaluation)}", words.about(evaluation)]
    parts += [f"**{said}**" for said in words.warnings(evaluation)]
    parts += [words.note(evaluation), markdown(words.ANSWERS_HEAD, words.answer_rows(evaluation))]
    spans = (f"{head_of(name)} {words.interval_words(whole.interval[name], name)}" for name in NAMES)
    parts.append(f"95 % intervals of the first line: {', '.join(spans)}.")
    for heading, names in words.families(evaluation):
        parts += [f"## {heading}", _strata_table(evaluation, names)]
    return "\n\n".join([*parts, "![best](best.png) ![worst](worst.png)"]) + "\n"


def _strata_table(evaluation: Evaluation, names: Mapping[str, str]) -> str:
    """Network with intervals, and the trivial answer that is hardest to beat."""
    heads = [head_of(score) for score in words.TOLD]
    rivals = [r for r in [words.rival_of(evaluation, next(iter(names)))] if r is not None]
    rows = []
    for name, said in names.items():
        spans = evaluation.network[name].interval
        ours = [
            f"{words.value_of(evaluation.network, name, s)} ({words.interval_words(spans[s], s)})"
            for s in words.TOLD
        ]
        theirs = [
            f"{words.AGAINST[words.verdict(evaluation.margins[r][name][s])]} "
            f"{words.value_of(evaluation.baselines[r], name, s)}"
            for r in rivals
            for s in words.TOLD
        ]
        rows.append([said, f"{words.pixels(evaluation, name):,}", *ours, *theirs])
    return markdown(["", "pixels", *heads, *(f"beside {r}: {head}" for r in rivals for head in heads)], rows)


def _one_per_clip(ranked: Sequence[Judged]) -> list[Judged]:
    """The first of each clip: neighbours on a flight look alike."""
    first: dict[str, Judged] = {}
    for judged in ranked:
        first.setdefault(judged.clip, judged)
    return list(first.values())[:SHOWN]


def _answered(
    some: Sequence[Judged], evaluation: Evaluation, checkpoint: Checkpoint, data: TrainingData
) -> list[tuple[Judged, Answer]]:
    """Ask once more about a few images."""
    samples = Samples(data.root, evaluation.split, checkpoint.network.inputs)
    asked = samples.only([judged.index for judged in some])
    return list(zip(some, answers(checkpoint.network.metres, asked), strict=True))


def _sheet(title: str, shown: Sequence[tuple[Judged, Answer]], evaluation: Evaluation) -> bytes:
    rows = [
        (f"{judged.key}  RMSE {judged.scores.rmse_m:.1f} m, Rel {judged.scores.rel:.2f}", answer)
        for judged, answer in shown
    ]
    buffer = io.BytesIO()
    answer_sheet(title, rows, evaluation.valid.furthest_m).save(buffer, "PNG")
    return buffer.getvalue()
