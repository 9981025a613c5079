"""Render once, sense many: thermal frames of stored radiance through a camera with fresh noise, epoch by epoch."""

from __future__ import annotations

from scenegen_datasets.sensing.retake import Retake as Redrawn

__all__ = ["Redrawn"]
