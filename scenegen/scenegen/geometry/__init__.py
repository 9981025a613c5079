"""Triangles: the mesh types and the builders every map shares."""
