"""Judge a network on a split, beside answers that look at no image."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.answers import answers
from scenegen_trainers.evaluation.baselines import trivial_answers
from scenegen_trainers.evaluation.bootstrap import Interval
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE, Judge, Margins, Standings, clip_of
from scenegen_trainers.evaluation.trend import Trend, TrendMeter
from scenegen_trainers.metrics import DepthReport, DepthScores, ValidDepth
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.pilots.camera_check import HFOV_TOLERANCE_DEG
from scenegen_trainers.training.samples import Samples
from scenegen_trainers.training.source import TrainingData

NETWORK = "network"
"""Its name among the contenders."""


@dataclass(frozen=True)
class Judged:
    """One image.

    Attributes
    ----------
    index : int
        Of the sample in its split.
    key, clip : str
    scores : DepthScores
    """

    index: int
    key: str
    clip: str
    scores: DepthScores


@dataclass(frozen=True)
class Evaluation:
    """What came of it.

    Attributes
    ----------
    record : mapping
        Of the checkpoint.
    dataset : mapping of str to str
    split : str
    valid : ValidDepth
        Pixels that count.
    network : mapping of str to Standing
        Its scores by stratum.
    baselines : mapping of str to (mapping of str to Standing)
        Those of each answer that looks at no image, on the same pixels.
    margins : mapping of str to (mapping of str to (mapping of str to (float, float)))
        By how much the network is better than each of these, by stratum and score.
    trends : mapping of str to Trend
        Answers by true depth: of the network and of each baseline.
    images : tuple of Judged
        Each image that has valid pixels.
    """

    record: Mapping[str, Any]
    dataset: Mapping[str, str]
    split: str
    valid: ValidDepth
    network: Standings
    baselines: Mapping[str, Standings]
    margins: Mapping[str, Margins]
    trends: Mapping[str, Trend]
    images: tuple[Judged, ...]

    @property
    def report(self) -> DepthReport:
        """Sky and everything beyond the cap left out."""
        return self.network[WHOLE].report

    @property
    def painted(self) -> DepthReport:
        """Sky and everything beyond judged as if it stood at the cap."""
        return self.network[PAINTED].report

    @property
    def interval(self) -> Mapping[str, Interval]:
        """Of the pooled scores of `report`, 95 %."""
        return self.network[WHOLE].interval


def evaluate(
    checkpoint: Checkpoint,
    data: TrainingData,
    split: str = "test",
    pairs: int = 0,
    *,
    thorough: bool = True,
    device: Any = "cpu",
    watch: Callable[[int, int], None] = lambda done, total: None,
) -> Evaluation:
    """Judge a network.

    Parameters
    ----------
    checkpoint : Checkpoint
    data : TrainingData
    split : str
    pairs : int
        So many, evenly spread; 0 takes all.
    thorough : bool
        Strata and baselines, too.
    device : torch device
    watch : callable
        Told how many samples of how many are done.

    Raises
    ------
    InputError
        If the frames differ from those it was trained on, or the dataset lacks a layer it needs.
    """
    network = checkpoint.network.to(device)
    check_frames(checkpoint, data)
    samples = Samples(data.root, split, network.inputs, pairs)
    facts = _facts(data, split, thorough)
    valid = ValidDepth(furthest_m=network.target.cap_m)
    rivals = trivial_answers(data.root, valid) if thorough else {}
    judges = {name: Judge(valid, stratified=thorough) for name in (NETWORK, *rivals)}
    trends = {name: TrendMeter(valid) for name in judges}
    images: list[Judged] = []
    for answer in answers(network.metres, samples, device):
        index, truth = int(samples.index[answer.position]), answer.truth_m
        sample = facts[index]
        for name, estimate in ((NETWORK, answer.estimate_m), *rivals.items()):
            scores = judges[name].add(estimate, truth, sample)
            trends[name].add(estimate, truth)
            if name == NETWORK and scores is not None:
                images.append(Judged(index, str(sample["key"]), clip_of(sample), scores))
        watch(answer.position + 1, len(samples))
    standings = {name: judge.standings() for name, judge in judges.items()}
    return Evaluation(
        record=checkpoint.record,
        dataset=data.record(),
        split=split,
        valid=valid,
        network=standings[NETWORK],
        baselines={name: standings[name] for name in rivals},
        margins={name: judges[NETWORK].margins(judges[name]) for name in rivals},
        trends={name: meter.trend() for name, meter in trends.items()},
        images=tuple(images),
    )


def check_frames(checkpoint: Checkpoint, data: TrainingData) -> None:
    """A network is judged on frames like those it was trained on.

    Raises
    ------
    InputError
        If image size or field of view differ.
    """
    trained, given = checkpoint.camera, data.camera()
    same = all(trained[k] == given[k] for k in ("width_px", "height_px"))
    if not same or abs(trained["hfov_deg"] - given["hfov_deg"]) > HFOV_TOLERANCE_DEG:
        raise InputError(
            f"{data.root} has {_in_words(given)}, the network was trained on {_in_words(trained)}; "
            "evaluate it on a dataset of its own camera"
        )


def _in_words(camera: Mapping[str, Any]) -> str:
    return f"{camera['width_px']}x{camera['height_px']} px over {camera['hfov_deg']:.4g} deg"


def _facts(data: TrainingData, split: str, thorough: bool) -> PairDataset:
    """The split once more, with classes where they are stored."""
    if thorough and "semantic" in data.layers:
        return PairDataset(data.root, split, ("semantic",))
    return PairDataset(data.root, split, ())
