"""Flights that somebody flew, read from files of others."""
