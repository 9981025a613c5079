"""Geometry meets sun and sky: one pass of rays per world, from which every weather and hour draws."""
