"""The recipe of a training: model, profile, file and flags, key by key, to one validated whole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field

from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.section import Count, Number, Section
from scenegen_datasets.resolve import Source, resolve
from scenegen_trainers.inputs.knobs import InputKnobs, TargetKnobs
from scenegen_trainers.models.knobs import FastDepthKnobs, LiteMonoKnobs, Pix2PixKnobs


class TrainingKnobs(Section):
    """How long, how fast, on what."""

    steps: Annotated[Count, Field(ge=1, le=100_000_000)] = 40_000
    """Batches to learn from."""
    batch: Annotated[Count, Field(ge=1, le=4096)] = 4
    """Samples a step, over all devices together."""
    learning_rate: Annotated[Number, Field(gt=0.0, le=1.0)] = 2e-4
    """Of Adam at the start."""
    decay_from: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.5
    """Share of the steps after which the learning rate falls linearly towards zero."""
    mirror: Literal[True, False, "embedded"] = True
    """Show every sample mirrored half of the time. Thermal image and flow are mirrored, then embedded (true), so that
    the grid of Eq. (1) stays where it is; embedded mirrors the embedded image, which moves the grid unless the width is
    one more than a multiple of the interval; false mirrors nothing."""
    noise: Literal["stored", "redrawn"] = "stored"
    """Thermal frames as they are stored, or sensed anew from radiance at every epoch with noise of its own: one
    render, many cameras. Needs the layer radiance."""
    pairs: Annotated[Count, Field(ge=0)] = 0
    """Learn from so many pairs, evenly spread over the split; 0 takes all."""
    keep: Annotated[Count, Field(ge=1)] = 500
    """Steps between two saved states, from which a killed training resumes."""
    judge: Annotated[Count, Field(ge=1)] = 1000
    """Steps between two scores on the validation split, with sample pictures."""
    judge_pairs: Annotated[Count, Field(ge=1)] = 64
    """Validation pairs scored, evenly spread."""
    log: Annotated[Count, Field(ge=1)] = 20
    """Steps between two rows of the log."""
    workers: Annotated[Count, Field(ge=0, le=256)] = 0
    """Processes that prepare samples; 0 prepares them in this one and keeps them in memory."""


class TrainingRecipe(Section):
    """Everything that decides what a training ends in, but for dataset and arithmetic of the device."""

    model: str = "pix2pix-flow"
    """One of `MODELS`."""
    seed: Annotated[Count, Field(ge=0)] = 0
    """Of initial weights, order of samples, mirroring and dropout."""
    network: Literal["pix2pix", "fastdepth", "litemono"] = "pix2pix"
    """Architecture; a model is one of these with some keys set."""
    inputs: InputKnobs = InputKnobs()
    target: TargetKnobs = TargetKnobs()
    training: TrainingKnobs = TrainingKnobs()
    pix2pix: Pix2PixKnobs = Pix2PixKnobs()
    fastdepth: FastDepthKnobs = FastDepthKnobs()
    litemono: LiteMonoKnobs = LiteMonoKnobs()

    @property
    def knobs(self) -> Section:
        """Of the architecture."""
        section: Section = getattr(self, self.network)
        return section

    def network_config(self) -> dict[str, Any]:
        """Arguments of `DepthNetwork`."""
        return {
            "architecture": self.network,
            "knobs": self.knobs.model_dump(mode="json"),
            "inputs": self.inputs.model_dump(mode="json"),
            "target": self.target.model_dump(mode="json"),
        }

    def deciding(self) -> dict[str, Any]:
        """Plain data of every key that decides the result; how often it is saved or shown does not."""
        unused = {"pix2pix", "fastdepth", "litemono"} - {self.network}
        whole = self.model_dump(mode="json", exclude=unused)
        for key in ("keep", "judge", "judge_pairs", "log", "workers"):
            del whole["training"][key]
        return whole


MODELS: Mapping[str, Mapping[str, Any]] = {
    "pix2pix": {"network": "pix2pix", "inputs": {"flow": "none"}},
    "pix2pix-flow": {"network": "pix2pix", "inputs": {"flow": "farneback"}},
    "fastdepth": {
        "network": "fastdepth",
        "inputs": {"flow": "none"},
        "target": {"scale": "log"},
        "training": {"learning_rate": 1e-3, "decay_from": 0.0},
    },
    "litemono": {
        "network": "litemono",
        "inputs": {"flow": "none"},
        "target": {"scale": "log"},
        "training": {"learning_rate": 1e-3, "decay_from": 0.0},
    },
}
"""Models by name: keys they set. pix2pix is the paper's conventional method, pix2pix-flow the proposed one, both with
linear depth pictures; what learns by a logarithmic error paints depth logarithmically."""

PROFILES: Mapping[str, Mapping[str, Any]] = {
    "ci": {
        "pix2pix": {"width": 16, "judge_width": 16},
        "fastdepth": {"width": 0.25},
        "litemono": {"width": 0.5},
        "training": {"steps": 600, "batch": 4, "keep": 200, "judge": 300, "judge_pairs": 32},
    },
    "small": {
        "pix2pix": {"width": 16, "judge_width": 16},
        "fastdepth": {"width": 0.5},
        "litemono": {"width": 0.5},
        "training": {"steps": 2000, "batch": 4},
    },
    "paper": {"training": {"steps": 40_000, "batch": 4, "keep": 1000, "judge": 2000, "workers": 4}},
}
"""Sizes of a training: a minute of a core, three minutes of a core (40 for Table 1), the paper's network on a GPU."""


def resolve_training(model: str, profile: str, sources: Sequence[Source]) -> TrainingRecipe:
    """Compose a recipe: model < profile < file < flags.

    Parameters
    ----------
    model : str
        Of `MODELS`.
    profile : str
        Of `PROFILES`.
    sources : sequence of Source
        From weakest to strongest.

    Raises
    ------
    InputError
        In one line, naming file and key.
    """
    if model not in MODELS:
        raise InputError(f"--model {model}: unknown model{nearest(model, MODELS)}")
    if profile not in PROFILES:
        raise InputError(f"--profile {profile}: unknown profile{nearest(profile, PROFILES)}")
    named = Source(f"model {model}", {**MODELS[model], "model": model})
    sized = Source(f"profile {profile}", PROFILES[profile])
    return resolve(TrainingRecipe, [sized, named, *sources])
