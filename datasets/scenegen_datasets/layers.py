"""The layers of a frame: their names, types and units, and the member each one is stored in."""

from __future__ import annotations

DEFAULT_LAYERS: tuple[str, ...] = (
    "thermal",
    "depth",
    "flow",
    "covisible",
    "radiance",
    "temperature",
    "semantic",
    "instance",
    "material",
)
"""What is written unless the recipe says otherwise; ``flow_back``, ``covisible_back`` and ``normal`` on request."""
