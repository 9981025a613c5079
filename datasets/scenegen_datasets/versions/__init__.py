"""Versions of a dataset: what changed, which number that needs, releases, comparison, union."""
