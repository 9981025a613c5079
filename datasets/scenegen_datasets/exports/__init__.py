"""Exports: the dataset in formats that other people's tools read, each with a stated range and loss.

A format is one file in `formats`; `engine.export` does what all of them share. Conventions of others (NED, OpenGL,
integer pixel centres, millimetres) live here and nowhere else.
"""
