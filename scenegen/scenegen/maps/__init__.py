"""The map families, one folder each."""
