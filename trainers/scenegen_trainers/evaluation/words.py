"""An evaluation in words and cells, which page and Markdown share. Nothing in it differs between two evaluations of
the same network on the same pairs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from scenegen_trainers.evaluation.baselines import PAINTED_ROW_MEAN, ROW_MEAN
from scenegen_trainers.evaluation.bootstrap import Interval
from scenegen_trainers.evaluation.evaluate import Evaluation
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE, Standings
from scenegen_trainers.evaluation.scores import HEADS, NAMES, figure, named, rounded
from scenegen_trainers.evaluation.strata import of_family
from scenegen_trainers.metrics import DepthScores

RIVAL = {WHOLE: ROW_MEAN, PAINTED: PAINTED_ROW_MEAN}
"""The trivial answer that is hardest to beat, by stratum; in all others that of `WHOLE`."""

FAMILIES = {
    "distance": "By true distance",
    "light": "By day and by night",
    "map": "By map",
    "class": "By class",
}
"""Headings of the families of strata."""

NOTE = (
    "Scores are pooled over all pixels with a true depth from {near:g} m to below {far:g} m, sky left out, but where "
    "a line says otherwise. Intervals hold 95 % of 1,000 draws of whole clips, because frames of one flight resemble "
    "each other; a difference is drawn on the same clips for both. Trivial answers are learned from the training split "
    "and look at no image."
)

TOLD = NAMES[:3]
"""Scores of every stratum; tables of all answers have all five."""

ANSWERS_HEAD = ("counted", "answer", *HEADS, "pixels")

_WAYS = (
    ("sky left out", WHOLE, "pooled"),
    ("mean over images", WHOLE, "per_image"),
    ("median-aligned", WHOLE, "pooled_aligned"),
    ("median-aligned, mean over images", WHOLE, "per_image_aligned"),
    ("sky as cap", PAINTED, "pooled"),
)
"""Words, stratum and attribute of its report."""


def title(evaluation: Evaluation) -> str:
    """Heading."""
    record, data = evaluation.record, evaluation.dataset
    seed = f", seed {record['seed']}," if "seed" in record else ""
    return f"{record.get('model', 'network')}{seed} on {data['name']} {data['version']}, split {evaluation.split}"


def about(evaluation: Evaluation) -> str:
    """How many images, and how the network came to be; one paragraph."""
    report, record = evaluation.report, evaluation.record
    clips = len({image.clip for image in evaluation.images})
    said = [f"{report.images:,} images of {clips:,} flights, {report.pixels:,} pixels."]
    if report.skipped:
        said.append(f"{report.skipped:,} more images have no valid pixel.")
    if report.missing:
        said.append(f"{report.missing:,} pixels have no answer and count as the worst one.")
    trained = record.get("dataset")
    if "step" in record and isinstance(trained, Mapping):
        same = trained.get("content_id") == evaluation.dataset["content_id"]
        where = "this dataset" if same else f"another dataset, {trained.get('name')} {trained.get('version')}"
        said.append(f"Trained for {record['step']:,} steps on {where}.")
    return " ".join(said)


def warnings(evaluation: Evaluation) -> list[str]:
    """What a reader has to know before any figure."""
    trained = evaluation.record.get("dataset")
    same = isinstance(trained, Mapping) and trained.get("content_id") == evaluation.dataset["content_id"]
    said = []
    if same and evaluation.split == "train":
        said.append("The network has learned from these very pairs; this says nothing about new ones.")
    if len({image.clip for image in evaluation.images}) == 1:
        said.append("All images are of one flight: intervals have no width and mean nothing.")
    return said


def note(evaluation: Evaluation) -> str:
    """What the figures mean."""
    return NOTE.format(near=evaluation.valid.nearest_m, far=evaluation.valid.furthest_m)


def rival_of(evaluation: Evaluation, stratum: str) -> str | None:
    """The trivial answer to hold a stratum against; None where there is none."""
    name = RIVAL.get(stratum, ROW_MEAN)
    return name if name in evaluation.baselines else None


def families(evaluation: Evaluation) -> Iterator[tuple[str, dict[str, str]]]:
    """Headings and strata: whole names to their own words; classes and maps with the most pixels first."""
    for first, heading in FAMILIES.items():
        names = of_family(evaluation.network, first)
        order = list(names) if first == "distance" else sorted(names, key=lambda n: -pixels(evaluation, n))
        if names:
            yield heading, {name: names[name].replace("_", " ") for name in order}


def pixels(evaluation: Evaluation, stratum: str) -> int:
    """Valid ones of a stratum."""
    return evaluation.network[stratum].report.pixels


def answer_rows(evaluation: Evaluation, *, briefly: bool = False) -> list[Sequence[str]]:
    """All contenders in all ways of counting; briefly: pooled, without and with the sky."""
    contenders = {"network": evaluation.network, **evaluation.baselines}
    rows: list[Sequence[str]] = []
    for way, stratum, kind in _WAYS:
        if briefly and kind != "pooled":
            continue
        for k, (name, standings) in enumerate(contenders.items()):
            report = standings[stratum].report
            scores: DepthScores = getattr(report, kind)
            count = f"{report.pixels:,}" if k == 0 and kind == "pooled" else ""
            rows.append(["" if k else way, name, *rounded(named(scores)), count])
    return rows


def value_of(standings: Standings, stratum: str, name: str) -> str:
    """A pooled score of a stratum."""
    return figure(name, named(standings[stratum].report.pooled)[name])


def interval_words(span: Interval, name: str) -> str:
    """``12.66 to 17.43``."""
    return f"{figure(name, span[0])} to {figure(name, span[1])}"


def shown(evaluation: Evaluation) -> str:
    """What stands in the pictures of answers; a reader would take embedded flow for dead pixels."""
    said = "Estimate and truth share one scale. Input is what the network is given."
    recipe = evaluation.record.get("recipe")
    inputs = recipe.get("inputs") if isinstance(recipe, Mapping) else None
    if not isinstance(inputs, Mapping) or inputs.get("flow", "none") == "none":
        return said
    if inputs.get("flow_shown", "embedded") != "embedded":
        return f"{said} The channel of flow is not shown."
    every = inputs.get("interval", 5)
    where = f"at every multiple of {every} in row and column" if every != 1 else "everywhere"
    return f"{said} Its dots are the simplified depth image, embedded {where}."


def verdict(margin: Interval) -> str:
    """ "better", "worse" or "open": what the interval of the network's margin says.

    One without width comes from a single flight, whose draws are all alike: it says nothing.
    """
    low, high = margin
    if low == high:
        return "open"
    return "better" if low > 0.0 else "worse" if high < 0.0 else "open"


AGAINST = {"better": "better than", "worse": "worse than", "open": "open against"}
"""A verdict before the name or figure it is held against."""
