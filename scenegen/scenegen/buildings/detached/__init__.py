"""Detached houses: rectangular bodies that abut, with gable, hip, shed and flat roofs that meet in valleys."""
