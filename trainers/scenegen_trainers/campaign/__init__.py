"""Campaigns: many flights of one or two pilots over the same missions, their statistics and their report."""
