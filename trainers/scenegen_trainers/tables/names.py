"""Names that the parts of the tables share."""

SCORES = "scores.json"
"""What one run of Table 1 scored."""

BOUNDS = ("oracle", "blind")
"""Pilots of Table 2: what true depth and no eyes at all make of the same missions."""
