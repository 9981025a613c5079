"""glTF before it is parsed: cut down to what is geometry, every name unique, nothing outside the file.

Materials, textures, cameras, animations and whatever else a file may carry never reach the parser. What remains are
nodes, triangles and the numbers behind them; the names that the sidecar refers to are kept apart.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.limits import MAX_FACES, MAX_PIECES, MAX_VERTICES
from scenegen.maps.own_scene.raw import Names

_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_TRIANGLES, _STRIP = 4, 5
_PLACE = ("matrix", "translation", "rotation", "scale")
_HARMLESS = (
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "EXT_texture_",
    "KHR_mesh_quantization",
    "KHR_xmp",
)
"""Extensions whose data does not change where a triangle lies."""
_MOVING = ("EXT_mesh_gpu_instancing",)
"""Extensions that change it although a file may call them optional."""


@dataclass(frozen=True)
class PrunedGltf:
    """A glTF file that holds nothing but geometry.

    Attributes
    ----------
    data : bytes
        In the container it came in.
    names : dict of str to Names
        Of each node that carries triangles, by its name in `data`.
    ignored : int
        Primitives that are not triangles: lines, points.
    """

    data: bytes
    names: dict[str, Names]
    ignored: int


def prune_glb(data: bytes) -> PrunedGltf:
    """Prune a binary glTF file.

    Raises
    ------
    InputError
        If it is no glTF 2 file, refers to other files, or uses what is not read.
    """
    if len(data) < 20 or struct.unpack_from("<II", data) != (_MAGIC, 2):
        raise InputError("is no binary glTF 2 file")
    chunks: dict[int, bytes] = {}
    at = 12
    while at + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, at)
        if at + 8 + size > len(data):
            raise InputError("is cut short")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    if _JSON not in chunks:
        raise InputError("has no glTF header")
    header, names, ignored = _prune(chunks[_JSON], binary=True)
    text = _padded(json.dumps(header).encode(), b" ")
    body = struct.pack("<II", len(text), _JSON) + text
    if _BIN in chunks:
        blob = _padded(chunks[_BIN], b"\0")
        body += struct.pack("<II", len(blob), _BIN) + blob
    return PrunedGltf(struct.pack("<III", _MAGIC, 2, 12 + len(body)) + body, names, ignored)


def prune_gltf(data: bytes) -> PrunedGltf:
    """Prune a glTF file in text form. Errors as `prune_glb`."""
    header, names, ignored = _prune(data, binary=False)
    return PrunedGltf(json.dumps(header).encode(), names, ignored)


def _prune(text: bytes, *, binary: bool) -> tuple[dict[str, Any], dict[str, Names], int]:
    try:
        header = json.loads(text.decode("utf-8"))
    except (ValueError, RecursionError):
        raise InputError("its glTF header is not JSON") from None
    if not isinstance(header, dict):
        raise InputError("its glTF header is not a mapping")
    _check_extensions(header)
    _check_buffers(header, binary=binary)
    meshes, primitives, ignored = _meshes(header)
    nodes, names = _nodes(header, primitives)
    if not names:
        raise InputError("has no node with triangles")
    pruned = {
        "asset": {"version": "2.0"},
        "buffers": header.get("buffers", []),
        "bufferViews": _dicts(header, "bufferViews"),
        "accessors": _dicts(header, "accessors"),
        "meshes": meshes,
        "nodes": nodes,
        "scenes": [{"nodes": _roots(header, nodes)}],
        "scene": 0,
    }
    return pruned, names, ignored


def _check_extensions(header: dict[str, Any]) -> None:
    used, required = (header.get(key) or [] for key in ("extensionsUsed", "extensionsRequired"))
    if not (isinstance(used, list) and isinstance(required, list)):
        raise InputError("its list of extensions is broken")
    for name in [*required, *(name for name in used if name in _MOVING)]:
        if not str(name).startswith(_HARMLESS):
            raise InputError(f"uses the extension {str(name)[:60]}; export it again without (uncompressed)")


def _check_buffers(header: dict[str, Any], *, binary: bool) -> None:
    for k, buffer in enumerate(_dicts(header, "buffers")):
        uri = buffer.get("uri")
        if uri is None and not (binary and k == 0):
            raise InputError("has a buffer without data")
        if uri is not None and not (
            isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri[:200]
        ):
            raise InputError(f"refers to another file, {str(uri)[:60]!r}; export it as one .glb")


def _meshes(header: dict[str, Any]) -> tuple[list[dict[str, Any]], list[list[tuple[int, str, str]]], int]:
    """One mesh per primitive; for each mesh of the file its (new mesh, mesh name, material name)."""
    accessors, materials = _dicts(header, "accessors"), _dicts(header, "materials")
    meshes: list[dict[str, Any]] = []
    primitives: list[list[tuple[int, str, str]]] = []
    ignored = 0
    for mesh in _dicts(header, "meshes"):
        primitives.append([])
        for primitive in _dicts(mesh, "primitives"):
            attributes = primitive.get("attributes")
            mode = primitive.get("mode", _TRIANGLES)
            if mode not in (_TRIANGLES, _STRIP) or not isinstance(attributes, dict):
                ignored += 1
                continue
            kept = {
                "attributes": {"POSITION": _accessor(accessors, attributes.get("POSITION"), "VEC3")},
                "mode": mode,
            }
            if "indices" in primitive:
                kept["indices"] = _accessor(accessors, primitive["indices"], "SCALAR")
            material = primitive.get("material")
            made_of = materials[_index(material, materials)] if material is not None else {}
            primitives[-1].append((len(meshes), _name(mesh), _name(made_of)))
            meshes.append({"name": f"m{len(meshes)}", "primitives": [kept]})
            if len(meshes) > MAX_PIECES:
                raise InputError(f"has more than {MAX_PIECES:,} parts; join some of them")
    return meshes, primitives, ignored


def _accessor(accessors: list[dict[str, Any]], index: Any, shape: str) -> int:
    accessor = accessors[_index(index, accessors)]
    count = accessor.get("count")
    if accessor.get("sparse") is not None or accessor.get("normalized"):
        raise InputError(
            "stores its triangles as sparse or normalized numbers; export it without compression"
        )
    if type(count) is int and count > MAX_VERTICES:
        raise InputError(f"has more than {MAX_FACES:,} triangles; decimate it or split it")
    if type(count) is not int or count < 0 or accessor.get("type") != shape:
        raise InputError(
            f"has an array of {str(count)[:20]} {str(accessor.get('type'))[:20]} where triangles belong"
        )
    return int(index)


def _nodes(
    header: dict[str, Any], primitives: list[list[tuple[int, str, str]]]
) -> tuple[list[dict[str, Any]], dict[str, Names]]:
    given = _dicts(header, "nodes")
    nodes: list[dict[str, Any]] = []
    names: dict[str, Names] = {}
    parts: list[dict[str, Any]] = []
    for k, node in enumerate(given):
        children = node.get("children", [])
        if not isinstance(children, list):
            raise InputError("has a node whose children are no list")
        kept: dict[str, Any] = {key: node[key] for key in _PLACE if key in node}
        kept |= {"name": f"n{k}", "children": [_index(child, given) for child in children]}
        for which, mesh, material in primitives[_index(node["mesh"], primitives)] if "mesh" in node else []:
            part = f"n{k}m{which}"
            names[part] = Names(_name(node), mesh, material, k)
            kept["children"].append(len(given) + len(parts))
            parts.append({"name": part, "mesh": which})
        nodes.append(kept)
        if len(given) + len(parts) > 2 * MAX_PIECES:
            raise InputError(f"has more than {MAX_PIECES:,} parts; join some of them")
    return nodes + parts, names


def _roots(header: dict[str, Any], nodes: list[dict[str, Any]]) -> list[int]:
    """Roots of the scene that is shown; every node has one parent at most, so that nothing repeats without end."""
    children = [child for node in nodes for child in node.get("children", [])]
    if len(set(children)) < len(children):
        raise InputError("has a node with two parents")
    free = sorted(set(range(len(nodes))) - set(children))
    scenes = _dicts(header, "scenes")
    if not scenes:
        return free
    chosen = scenes[_index(header.get("scene", 0), scenes)].get("nodes", [])
    if not isinstance(chosen, list):
        raise InputError("has a scene without a list of nodes")
    roots = [_index(root, nodes) for root in chosen]
    if not set(roots) <= set(free) or len(set(roots)) < len(roots):
        raise InputError("has a scene that starts inside of itself")
    return roots


def _dicts(holder: dict[str, Any], key: str) -> list[dict[str, Any]]:
    found = holder.get(key) or []
    if not (isinstance(found, list) and all(isinstance(item, dict) for item in found)):
        raise InputError(f"its glTF header holds no proper list of {key}")
    return found


def _index(value: Any, items: list[Any]) -> int:
    if type(value) is not int or not 0 <= value < len(items):
        raise InputError(f"its glTF header refers to item {str(value)[:20]} of a list of {len(items)}")
    return value


def _name(item: dict[str, Any]) -> str:
    name = item.get("name", "")
    return name if isinstance(name, str) else ""


def _padded(data: bytes, filler: bytes) -> bytes:
    return data + filler * (-len(data) % 4)
