"""One contender, network or trivial answer, and all its scores: whole, with sky, stratum by stratum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.foundation.rng import stream
from scenegen_trainers.evaluation.bootstrap import Interval, intervals, margins, sums_of
from scenegen_trainers.evaluation.strata import strata_of
from scenegen_trainers.metrics import DepthMeter, DepthReport, DepthScores, ValidDepth

WHOLE = "whole"
"""All valid pixels: sky and everything beyond the cap left out."""

PAINTED = "painted"
"""All pixels, with sky and everything beyond judged as if it stood at the cap: a depth picture as a picture."""


@dataclass(frozen=True)
class Standing:
    """Scores of a contender in one stratum.

    Attributes
    ----------
    report : DepthReport
    interval : mapping of str to (float, float)
        Bootstrap over clips, 95 %, of ``report.pooled``, by name of the score.
    """

    report: DepthReport
    interval: Mapping[str, Interval]


Standings = Mapping[str, Standing]
"""By stratum: `WHOLE`, `PAINTED` and those of `scenegen_trainers.evaluation.strata`."""

Margins = Mapping[str, Mapping[str, Interval]]
"""By stratum and score: by how much better than a rival, 95 %."""


class Judge:
    """Collects what a contender answered.

    Parameters
    ----------
    valid : ValidDepth
        Pixels that count.
    stratified : bool
        Judge every stratum, not only the whole.
    """

    def __init__(self, valid: ValidDepth, *, stratified: bool) -> None:
        self._valid, self._stratified = valid, stratified
        self._meters = {
            WHOLE: _ClipMeter(valid),
            PAINTED: _ClipMeter(replace(valid, beyond_as_furthest=True)),
        }

    def add(
        self,
        estimate_m: Float32[np.ndarray, "rows columns"],
        truth_m: Float32[np.ndarray, "rows columns"],
        sample: Mapping[str, Any],
    ) -> DepthScores | None:
        """Judge one image; returns its scores, None if it has no valid pixel.

        Parameters
        ----------
        estimate_m, truth_m : float32 (rows, columns)
            Planar depth [m].
        sample : mapping
            Of the dataset: where the image belongs.
        """
        clip = clip_of(sample)
        self._meters[PAINTED].add(estimate_m, truth_m, clip)
        if self._stratified:
            for name, part_m in strata_of(truth_m, sample, self._valid):
                self._meters.setdefault(name, _ClipMeter(self._valid)).add(estimate_m, part_m, clip)
        return self._meters[WHOLE].add(estimate_m, truth_m, clip)

    def standings(self) -> dict[str, Standing]:
        """Of every stratum with a valid pixel.

        Raises
        ------
        InputError
            If there is no valid pixel at all.
        """
        self._meters[WHOLE].meter.report()  # says so
        return {
            name: Standing(m.meter.report(), intervals(m.clips, _rng(name)))
            for name, m in self._meters.items()
            if m.clips
        }

    def margins(self, rival: Judge) -> dict[str, dict[str, Interval]]:
        """By how much it is better than a rival that judged the same images, stratum by stratum."""
        return {
            name: margins(m.clips, rival._meters[name].clips, _rng(name))
            for name, m in self._meters.items()
            if m.clips
        }


def clip_of(sample: Mapping[str, Any]) -> str:
    """Clip of a dataset's sample."""
    return f"{sample['map']}-{sample['world']}/{sample['clip']}"


class _ClipMeter:
    """A meter, and what each clip added to it."""

    def __init__(self, valid: ValidDepth) -> None:
        self.meter = DepthMeter(valid)
        self.clips: dict[str, Float64[np.ndarray, "6"]] = {}

    def add(
        self,
        estimate_m: Float32[np.ndarray, "rows columns"],
        truth_m: Float32[np.ndarray, "rows columns"],
        clip: str,
    ) -> DepthScores | None:
        before = self.meter.pixels
        scores = self.meter.add(estimate_m, truth_m)
        if scores is not None:
            some = sums_of(scores, self.meter.pixels - before)
            self.clips[clip] = self.clips[clip] + some if clip in self.clips else some
        return scores


def _rng(name: str) -> np.random.Generator:
    return stream(0, "bootstrap", *([] if name == WHOLE else [name]))
