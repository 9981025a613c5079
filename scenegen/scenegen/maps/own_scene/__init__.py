"""Scenes of the user's own: a file of triangles and a sidecar that says what they are made of, as a world."""
