"""What is to be made and where, with what can be known before anything is made."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError, ScenegenError
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import layers_by_member
from scenegen_datasets.place import check_room, existing_part, make_directory
from scenegen_datasets.plan import plan
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.store import check_output, finished

BYTES_PER_PIXEL = {
    "thermal.png": 1.1,
    "depth.tiff": 2.3,
    "flow.exr": 8.2,
    "truth.exr": 7.7,
    "flow_back.exr": 8.4,
    "normal.exr": 10.0,
    "imu.npy": 0.0,  # some kilobytes, whatever the size of the picture
}
"""Size of each member of a frame on disk; measured on city flights, on the high side."""

BYTES_PER_FRAME = 12_000
"""Headers, padding and metadata of a frame."""


@dataclass(frozen=True)
class Job:
    """What to make, where.

    Attributes
    ----------
    recipe : Recipe
    pairs : int
        A whole number of clips (`scenegen_datasets.recipe.settle_pairs`).
    root : Path
        Dataset directory; made if it does not exist.
    asked : mapping
        What the user asked for, as plain data, for ``recipe.yaml``.
    processes : int
        Worker processes.
    allow_mixed : bool
        Accept frames of another render fingerprint in the same dataset.
    license : str or None
        Of the data, by its SPDX name; None leaves it as it is, or the default.
    """

    recipe: Recipe
    pairs: int
    root: Path
    asked: Mapping[str, Any]
    processes: int
    allow_mixed: bool = False
    license: str | None = None

    @property
    def name(self) -> str:
        """Of the dataset."""
        return dataset_name(self.root)

    @cached_property
    def clips(self) -> tuple[ClipJob, ...]:
        """The plan, as far as it is to be made."""
        recipe = self.recipe
        held, first = recipe.splits.test_maps, recipe.first_world
        return plan(recipe.map, recipe.clips_per_world, recipe.pairs_per_clip, self.pairs, held, first)

    @property
    def bytes(self) -> int:
        """Estimated size of the whole dataset."""
        camera = self.recipe.camera
        frames = sum(clip.frames for clip in self.clips)
        per_pixel = sum(BYTES_PER_PIXEL[member] for member in layers_by_member(self.recipe.stored_layers))
        return round(frames * (camera.width_px * camera.height_px * per_pixel + BYTES_PER_FRAME))


def dataset_name(root: Path) -> str:
    """Name of a dataset: its directory's, in letters every tool takes."""
    return re.sub(r"[^a-z0-9._-]+", "-", root.resolve().name.lower()).strip("-.")[:64] or "dataset"


def prepare(job: Job) -> None:
    """Make the directory, after refusing what cannot end well; nothing is started, and nothing written in vain.

    Raises
    ------
    InputError
        If the output cannot be written, or holds something that is not a dataset.
    NoSpaceError
        If what is missing does not fit on the device.
    """
    try:
        existing = existing_part(job.root)
        if not os.access(existing, os.W_OK | os.X_OK):
            raise InputError(f"--out {job.root}: {existing} cannot be written; choose another --out")
        if existing == job.root.absolute():
            check_output(job.root)
        done = finished(job.root) if job.root.is_dir() else set()
        missing = sum(clip.name not in done for clip in job.clips)
        need_bytes = job.bytes * missing / len(job.clips)
        check_room(
            job.root, existing, need_bytes, "ask for fewer pairs or fewer layers, or choose another --out"
        )
    except ScenegenError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(
            f"--out {str(job.root)[:80]!r}: cannot be used: {reason}; choose another --out"
        ) from None
    make_directory(job.root)
