"""Boats: hulls, masts, stays and engines."""
