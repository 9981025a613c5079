"""Which file a scene of the user's own is read from."""

from __future__ import annotations

from typing import Annotated

from pydantic import StringConstraints

from scenegen.foundation.section import Section


class OwnScene(Section):
    """A scene file, with its sidecar beside it."""

    file: Annotated[str, StringConstraints(max_length=4096)] = ""
    """Path of the scene: .glb, .gltf, .obj or .ply. Empty where a recipe is read back from a dataset, which knows the
    content and not the place."""

    sha256: Annotated[str, StringConstraints(pattern=r"[0-9a-f]{64}|")] = ""
    """Identity of scene and sidecar (see `scenegen.maps.own_scene.identity`); filled in when the recipe is read. Files
    that differ from it are refused."""
