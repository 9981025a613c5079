"""Judge a network on a split: pooled and per image, aligned and not, by range, map, hour and class, with intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.answers import answers
from scenegen_trainers.evaluation.baselines import fit_baselines
from scenegen_trainers.evaluation.bootstrap import Judged, intervals
from scenegen_trainers.evaluation.strata import by_class, strata_of
from scenegen_trainers.metrics import DepthMeter, DepthReport, DepthScores, ValidDepth
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.training.samples import Samples, spread
from scenegen_trainers.training.source import TrainingData


@dataclass(frozen=True)
class Trivial:
    """Scores of an answer that looks at no image.

    Attributes
    ----------
    report, painted : DepthReport
        As in `Evaluation`.
    """

    report: DepthReport
    painted: DepthReport


@dataclass(frozen=True)
class Evaluation:
    """What came of it.

    Attributes
    ----------
    record : mapping
        Of the checkpoint.
    dataset : mapping of str to str
    split : str
    report : DepthReport
        Sky and everything beyond the cap left out.
    painted : DepthReport
        With sky and everything beyond judged as if it stood at the cap: a depth picture as a picture.
    interval : mapping of str to (float, float)
        Bootstrap over clips, 95 %, of ``report.pooled``.
    strata : mapping of str to DepthReport
        By map, day and night, class.
    baselines : mapping of str to Trivial
        Answers that look at no image, on the same pixels.
    images : tuple of (str, Judged)
        Key and scores of each image that has valid pixels.
    cap_m : float
        Where the valid range ends [m].
    """

    record: Mapping[str, Any]
    dataset: Mapping[str, str]
    split: str
    report: DepthReport
    painted: DepthReport
    interval: Mapping[str, tuple[float, float]]
    strata: Mapping[str, DepthReport]
    baselines: Mapping[str, Trivial]
    images: tuple[tuple[str, Judged], ...]
    cap_m: float


@dataclass
class _Meters:
    """One for each thing that is asked."""

    valid: ValidDepth
    whole: DepthMeter = field(init=False)
    painted: DepthMeter = field(init=False)
    strata: dict[str, DepthMeter] = field(default_factory=dict)

    def __post_init__(self) -> None:
        near, far = self.valid.nearest_m, self.valid.furthest_m
        self.whole = DepthMeter(self.valid)
        self.painted = DepthMeter(ValidDepth(near, far, beyond_as_furthest=True))

    def add(
        self, estimate_m: Float32[np.ndarray, "rows columns"], truth_m: Float32[np.ndarray, "rows columns"]
    ) -> DepthScores | None:
        """Judge an image both ways; returns its scores with sky left out."""
        self.painted.add(estimate_m, truth_m)
        return self.whole.add(estimate_m, truth_m)

    def stratum(self, name: str) -> DepthMeter:
        return self.strata.setdefault(name, DepthMeter(self.valid))


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
    meters = _Meters(valid)
    images: list[tuple[str, Judged]] = []
    for answer in answers(network.metres, samples, device):
        index = int(samples.index[answer.position])
        sample = facts[index]
        scores = meters.add(answer.estimate_m, answer.truth_m)
        if scores is not None:
            pixels = int(((answer.truth_m >= valid.nearest_m) & (answer.truth_m < valid.furthest_m)).sum())
            clip = f"{sample['map']}-{sample['world']}/{sample['clip']}"
            images.append((str(sample["key"]), Judged(index, clip, pixels, scores)))
        if thorough:
            _stratify(meters, sample, answer.estimate_m, answer.truth_m)
        watch(answer.position + 1, len(samples))
    report = meters.whole.report()
    return Evaluation(
        record=checkpoint.record,
        dataset=data.record(),
        split=split,
        report=report,
        painted=meters.painted.report(),
        interval=intervals([judged for _, judged in images], stream(0, "bootstrap")),
        strata={n: m.report() for n, m in sorted(meters.strata.items()) if m.pixels},
        baselines=judge_baselines(data, split, pairs, valid) if thorough else {},
        images=tuple(images),
        cap_m=valid.furthest_m,
    )


def judge_baselines(data: TrainingData, split: str, pairs: int, valid: ValidDepth) -> dict[str, Trivial]:
    """Trivial answers, learned from the training split, on the same pixels."""
    training = PairDataset(data.root, "train", ("depth",))
    if len(training) == 0:
        return {}
    baselines = fit_baselines(training, valid.furthest_m)
    judged = PairDataset(data.root, split, ("depth",))
    meters: dict[str, _Meters] = {}
    for index in spread(len(judged), pairs).tolist():
        truth = judged[index]["depth"]
        for name, answer in baselines.answers(truth.shape).items():
            meters.setdefault(name, _Meters(valid)).add(answer, truth)
    return {name: Trivial(m.whole.report(), m.painted.report()) for name, m in meters.items()}


def check_frames(checkpoint: Checkpoint, data: TrainingData) -> None:
    """A network is judged on frames like those it was trained on.

    Raises
    ------
    InputError
        If image size or field of view differ.
    """
    trained, given = checkpoint.camera, data.camera()
    same = all(trained[k] == given[k] for k in ("width_px", "height_px"))
    if not same or abs(trained["hfov_deg"] - given["hfov_deg"]) > 0.5:
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


def _stratify(
    meters: _Meters,
    sample: Mapping[str, Any],
    estimate_m: Float32[np.ndarray, "rows columns"],
    truth_m: Float32[np.ndarray, "rows columns"],
) -> None:
    for name in strata_of(sample):
        meters.stratum(name).add(estimate_m, truth_m)
    if "semantic" in sample:
        for name, truth in by_class(truth_m, sample["semantic"]):
            meters.stratum(name).add(estimate_m, truth)
