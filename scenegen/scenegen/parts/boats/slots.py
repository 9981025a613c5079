"""Surface slots of a boat."""

from __future__ import annotations

HULL, DECK, METAL, SAIL, GLASS, ENGINE, EXHAUST = range(7)
"""Hull and cabin; planks and inside; mast, stays and rails; cloth; windows; engine cover; exhaust."""

SLOTS = 7
