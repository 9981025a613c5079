"""Thermal radiation in a camera's band: Planck, sky, path, Fresnel. Pure functions of numpy arrays."""
