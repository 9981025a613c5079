"""Bring a damaged dataset back to the bytes it had."""
