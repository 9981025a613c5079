"""From receipts to a finished dataset: index, clip list, manifest, card, and ``dataset.json`` last."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from scenegen_datasets.info import DatasetInfo
from scenegen_datasets.job import ClipJob


def finish(root: Path, jobs: Sequence[ClipJob], *, version: str = "1.0.0") -> DatasetInfo:
    """Write everything that is derived from the receipts. Idempotent; the same bytes whoever made the clips.

    Parameters
    ----------
    root : Path
        Dataset with a lock (`create_or_open`) and receipts. Files under ``preview/`` are taken into the manifest.
    jobs : sequence of ClipJob
        The plan. Clips without a receipt (quarantined) are named in ``dataset.json`` as missing.
    version : str
        Semantic version of the data.
    """
    raise NotImplementedError
