"""The dataset of a training: its splits as samples, its camera, its identity."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_datasets.description import read_description
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.sensing.retake import Retake
from scenegen_datasets.store import DATASET
from scenegen_trainers.pilots.camera_check import frames_of
from scenegen_trainers.training.recipe import TrainingRecipe
from scenegen_trainers.training.samples import Samples


@dataclass(frozen=True)
class TrainingData:
    """A finished dataset.

    Attributes
    ----------
    root : Path
    name, version, content_id : str
    band_um : (float, float)
    layers : tuple of str
        What it stores.
    """

    root: Path
    name: str
    version: str
    content_id: str
    band_um: tuple[float, float]
    layers: tuple[str, ...]

    @classmethod
    def at(cls, root: Path) -> TrainingData:
        """Of a directory.

        Raises
        ------
        InputError
            If there is no finished dataset.
        """
        PairDataset(
            root, layers=(), allow_partial=True
        )  # says what is wrong with a directory that is no dataset
        if not (root / DATASET).is_file():
            raise InputError(f"{root} is still growing; finish it with `scenegen render` first")
        d = read_description(root / DATASET)
        low, high = d["band_um"]
        layers = tuple(layer["name"] for layer in d["layers"])
        return cls(root, d["name"], d["version"], d["content_id"], (float(low), float(high)), layers)

    def samples(
        self, split: str, recipe: TrainingRecipe, pairs: int = 0, *, keep: bool = False, stored: bool = False
    ) -> Samples:
        """A split as a recipe's network is shown it; with `stored`, frames as stored, whatever the recipe."""
        redraw = recipe.training.noise == "redrawn" and not stored
        redrawn = Retake.of(self.root, self.band_um, recipe.seed) if redraw else None
        embedded = recipe.training.mirror == "embedded"
        return Samples(self.root, split, recipe.inputs, pairs, keep, redrawn, embedded)

    def camera(self) -> dict[str, Any]:
        """Size and field of view of its frames, as checkpoints name them.

        Raises
        ------
        InputError
            If its frames are of several cameras: what is large in one is small in another, at the same distance.
        """
        pairs = PairDataset(self.root, layers=("thermal",))
        try:
            focal_px = float(pairs.intrinsics[0, 0])
        except InputError:
            raise InputError(
                f"{self.root} holds frames of several cameras; a network learns and is judged with one: merge "
                "datasets of one camera"
            ) from None
        rows, columns = pairs[0]["thermal"].shape
        return frames_of(columns, rows, focal_px)

    def record(self) -> dict[str, str]:
        """What checkpoints and reports say about it."""
        return {"name": self.name, "version": self.version, "content_id": self.content_id}
