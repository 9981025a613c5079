"""An evaluation on disk: JSON for machines, Markdown for people, sheets of the best and the worst answers."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import make_directories, write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_trainers.evaluation.answers import Answer, answers
from scenegen_trainers.evaluation.bootstrap import Judged, named
from scenegen_trainers.evaluation.evaluate import Evaluation
from scenegen_trainers.evaluation.pictures import answer_sheet
from scenegen_trainers.metrics import DepthReport, DepthScores
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.training.samples import Samples
from scenegen_trainers.training.source import TrainingData

SHOWN = 6
"""Answers on a sheet."""

HEAD = ("", "RMSE [m]", "Rel", "δ1", "δ2", "δ3", "pixels")


def write_report(
    evaluation: Evaluation, checkpoint: Checkpoint, data: TrainingData, out: Path
) -> tuple[Path, ...]:
    """Write ``evaluation.json``, ``evaluation.md``, ``best.png`` and ``worst.png``; returns their paths."""
    root = make_directories(out.parent, out.name)
    ranked = sorted(evaluation.images, key=lambda image: (image[1].scores.rel, image[0]))
    files = {
        "evaluation.json": pretty(as_json(evaluation)),
        "evaluation.md": as_markdown(evaluation).encode(),
        "best.png": _sheet("Best answers", _one_per_clip(ranked), evaluation, checkpoint, data),
        "worst.png": _sheet("Worst answers", _one_per_clip(ranked[::-1]), evaluation, checkpoint, data),
    }
    for name, content in files.items():
        write_atomic(root / name, content)
    return tuple(root / name for name in files)


def as_json(evaluation: Evaluation) -> dict[str, Any]:
    """Plain data, every digit."""
    return {
        "model": dict(evaluation.record),
        "dataset": dict(evaluation.dataset),
        "split": evaluation.split,
        "scores": report_json(evaluation.report),
        "painted": report_json(evaluation.painted),
        "interval_95": {name: list(span) for name, span in evaluation.interval.items()},
        "strata": {name: report_json(report) for name, report in evaluation.strata.items()},
        "baselines": {
            name: {**report_json(trivial.report), "painted": report_json(trivial.painted)}
            for name, trivial in evaluation.baselines.items()
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


def as_markdown(evaluation: Evaluation) -> str:
    """A page."""
    report, record = evaluation.report, evaluation.record
    low, high = evaluation.interval["rmse_m"], evaluation.interval["rel"]
    lines = [
        f"# {record.get('model', 'network')}, seed {record.get('seed', '?')}, on {evaluation.split}",
        "",
        f"{report.images} images of {evaluation.dataset['name']} {evaluation.dataset['version']}, "
        f"{report.skipped} without a valid pixel, {report.missing} pixels without an answer. Sky is judged only in "
        "the row that says so. Intervals (95 %, drawn by clip): "
        f"RMSE {low[0]:.2f} to {low[1]:.2f} m, Rel {high[0]:.3f} to {high[1]:.3f}.",
        "",
        *_rows([("pooled", report.pooled, report.pixels), *_ways(report)]),
        *_rows([("sky as cap, pooled", evaluation.painted.pooled, evaluation.painted.pixels)], head=False),
        "",
        "## By distance",
        "",
        *_rows((f"{a:g} to {b:g} m", scores, None) for a, b, scores in report.by_range if scores),
    ]
    if evaluation.baselines:
        lines += ["", "## Trivial answers", ""]
        lines += _rows((n, t.report.pooled, t.report.pixels) for n, t in evaluation.baselines.items())
    if evaluation.strata:
        lines += ["", "## By map, hour and class", ""]
        lines += _rows((n, r.pooled, r.pixels) for n, r in evaluation.strata.items())
    return "\n".join([*lines, "", "![best](best.png) ![worst](worst.png)", ""])


def _ways(report: DepthReport) -> Sequence[tuple[str, DepthScores, int | None]]:
    return (
        ("mean over images", report.per_image, None),
        ("pooled, median-aligned", report.pooled_aligned, None),
        ("mean over images, median-aligned", report.per_image_aligned, None),
    )


def _rows(rows: Iterable[tuple[str, DepthScores, int | None]], *, head: bool = True) -> list[str]:
    lines = [f"| {' | '.join(HEAD)} |", f"|{'---|' * len(HEAD)}"] if head else []
    for name, scores, pixels in rows:
        cells = [f"{scores.rmse_m:.3f}", *(f"{x:.3f}" for x in (scores.rel, *scores.delta))]
        lines.append(f"| {name} | {' | '.join(cells)} | {'' if pixels is None else f'{pixels:,}'} |")
    return lines


def _one_per_clip(ranked: Sequence[tuple[str, Judged]]) -> list[tuple[str, Judged]]:
    """The first of each clip: neighbours on a flight look alike."""
    first: dict[str, tuple[str, Judged]] = {}
    for key, judged in ranked:
        first.setdefault(judged.group, (key, judged))
    return list(first.values())[:SHOWN]


def _sheet(
    title: str,
    ranked: Sequence[tuple[str, Judged]],
    evaluation: Evaluation,
    checkpoint: Checkpoint,
    data: TrainingData,
) -> bytes:
    """Ask once more about a few images and draw the answers."""
    samples = Samples(data.root, evaluation.split, checkpoint.network.inputs)
    some = samples.only([judged.index for _, judged in ranked])
    rows: list[tuple[str, Answer]] = []
    for (key, judged), answer in zip(ranked, answers(checkpoint.network.metres, some), strict=True):
        rows.append((f"{key}  RMSE {judged.scores.rmse_m:.1f} m, Rel {judged.scores.rel:.2f}", answer))
    buffer = io.BytesIO()
    answer_sheet(title, rows, checkpoint.network.target.cap_m).save(buffer, "PNG")
    return buffer.getvalue()
