"""What is kept: plan, pipeline, files, versions, verification and loaders.

Importing this package imports numpy and the standard library only; cv2 and OpenEXR come with the first frame read.
"""

from __future__ import annotations

from scenegen_datasets.loader import PairDataset

__all__ = ["PairDataset"]
