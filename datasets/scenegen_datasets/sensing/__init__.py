"""Render once, sense many: stored radiance seen through another camera, while loading or as a new dataset."""
