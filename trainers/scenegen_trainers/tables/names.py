"""Names of files that a table's runs are made of."""

SCORES = "scores.json"
"""What one run scored."""
