"""Trees, shrubs and hedges of all maps."""
