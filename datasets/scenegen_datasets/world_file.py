"""A world as a file for other programs: glTF, OBJ or PLY, in class colours, with the sidecar that reads it back.

The faces of one class and material make one part, or, if asked for, those of one object. glTF and OBJ are turned y-up,
as their readers expect; PLY stays z-up. Heat is not exported: engines, heated rooms and movers stay behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import yaml
from jaxtyping import Float64, Int64

from scenegen.classes import CLASSES, SemanticClass
from scenegen.materials.material import Surface
from scenegen.world import World

ENDINGS = (".glb", ".gltf", ".obj", ".ply")

SIDECAR_MARK = "# Written by scenegen beside the scene it describes.\n"
"""First line of every sidecar that was written here, so that one written by hand is never overwritten."""

Nodes = Literal["class", "object"]


@dataclass(frozen=True, eq=False)
class Part:
    """Faces that go together.

    Attributes
    ----------
    name : str
        Unique.
    kind : SemanticClass
    surface : Surface
        The first of its variants.
    object : int
        Instance id; 0 where the part holds more than one.
    vertices : float64 (vertices, 3)
        [m], ENU.
    faces : int64 (faces, 3)
    """

    name: str
    kind: SemanticClass
    surface: Surface
    object: int
    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]

    @property
    def label(self) -> str:
        """Class and material: the name of its material in the file."""
        return f"{self.kind.name}/{self.surface.material.name}"


def parts_of(world: World, nodes: Nodes) -> list[Part]:
    """Split a world by class and material, and by object if asked for; sorted by that."""
    names = [s.material.name for s in world.palette]
    made_of = np.array([names.index(name) for name in names])[world.face_surface]
    owner = world.face_object.astype(np.int64) * (nodes == "object")
    key = np.stack([owner, world.face_semantic.astype(np.int64), made_of], axis=1)
    kinds, member = np.unique(key, axis=0, return_inverse=True)
    order = np.argsort(member.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(member.ravel(), minlength=len(kinds)))
    found = []
    for (thing, semantic, first), part in zip(kinds.tolist(), np.split(order, ends[:-1]), strict=True):
        used, faces = np.unique(world.mesh.faces[part], return_inverse=True)
        kind, surface = CLASSES[semantic], world.palette[first]
        label = f"{kind.name}/{surface.material.name}"
        found.append(
            Part(
                f"{label}/{thing}" if thing else label,
                kind,
                surface,
                thing,
                world.mesh.vertices[used].astype(np.float64),
                faces.reshape(-1, 3).astype(np.int64),
            )
        )
    return found


def world_file(parts: Sequence[Part], ending: str) -> bytes:
    """Encode parts.

    Parameters
    ----------
    parts : sequence of Part
    ending : str
        One of `ENDINGS`. PLY has no names: it holds all parts in one, told apart by their colours alone.
    """
    import trimesh

    assert ending in ENDINGS
    scene = trimesh.Scene()
    for part in parts:
        vertices = part.vertices if ending == ".ply" else part.vertices[:, [0, 2, 1]] * [1.0, 1.0, -1.0]
        mesh = trimesh.Trimesh(vertices, part.faces, process=False, validate=False)
        mesh.visual = _look(part, len(vertices), with_names=ending in (".glb", ".gltf"))
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name)
    return _encoded(scene, ending)


def sidecar(world: World, parts: Sequence[Part], ending: str) -> str:
    """The sidecar that says of an exported world what it was; empty for PLY, which has no names to refer to."""
    if ending == ".ply":
        return ""
    by_name = {part.label if ending in (".glb", ".gltf") else part.name: part for part in parts}
    plain = {
        "up_axis": "y",
        "materials": {name: _made_of(part.surface) for name, part in by_name.items()},
        "classes": {name: part.kind.name for name, part in by_name.items()},
        "flight_area_m": [*world.flight_box_m[0][:2], *world.flight_box_m[1][:2]],
        "flight_ceiling_m": world.flight_box_m[1][2] - float(world.ground.height_m.min()),
    }
    return SIDECAR_MARK + yaml.safe_dump(plain, sort_keys=False, width=120)


def _made_of(surface: Surface) -> str | dict[str, float]:
    if surface.material.id < 1000:
        return surface.material.name
    return {"temperature_K": surface.prescribed_K, "emissivity": surface.emissivity}


def _look(part: Part, vertices: int, *, with_names: bool) -> Any:
    """Class colour, as a named material where the format has them, else at the vertices."""
    from trimesh import visual

    colour = [*part.kind.colour, 255]
    if not with_names:
        return visual.ColorVisuals(vertex_colors=np.tile(np.array(colour, np.uint8), (vertices, 1)))
    material = visual.material.PBRMaterial(  # type: ignore[no-untyped-call]
        name=part.label, baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.9, doubleSided=True
    )
    return visual.TextureVisuals(material=material)  # type: ignore[no-untyped-call]


def _encoded(scene: Any, ending: str) -> bytes:
    if ending == ".ply":
        content = scene.to_geometry().export(file_type="ply")
    elif ending == ".gltf":
        content = scene.export(file_type="gltf", embed_buffers=True)["model.gltf"]
    else:
        content = scene.export(file_type=ending[1:])
    return content if isinstance(content, bytes) else str(content).encode()
