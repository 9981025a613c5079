"""Hostile scene files: small sound scenes, damaged at random or on purpose, and what reading them must come to.

``python tests/hostile_scenes.py 900`` reads so many mutants per format, each drawn from its own seed, and prints what
became of them; the test suite does the same with a few. A mutant is either refused in one line or repaired into sound
arrays. A child that dies is reported as a crash: it would not take its job along, but it is not wanted.
"""

from __future__ import annotations

import json
import struct
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen.foundation.rng import stream

ENDINGS = (".glb", ".gltf", ".obj", ".ply")
_HOSTILE = (
    -1,
    0,
    1,
    2**31,
    2**40,
    1e308,
    -1e30,
    "x",
    "",
    None,
    True,
    [],
    {},
    [0],
    [1e9] * 16,
    "../../etc/passwd",
)
_TOKENS = (
    b"-1",
    b"0",
    b"99999999",
    b"-99999999",
    b"nan",
    b"inf",
    b"1e400",
    b"f",
    b"v",
    b"1//",
    b"\xff\xfe",
    b"",
    b"1/2/3/4",
    b"\n",
)
_WORDS = (
    b"\xff\xff\xff\xff",
    b"\0\0\xc0\x7f",
    b"\0\0\x80\x7f",
    b"\0\0\0\0",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
)

Bytes = bytes
Mutation = Callable[[Bytes, np.random.Generator], Bytes]


def sound(ending: str) -> bytes:
    """A sound little scene: a plate, two boxes that share a mesh, a ball."""
    scene = trimesh.Scene()
    plate = trimesh.creation.box(extents=(40, 40, 1))
    plate.apply_translation((0, 0, -0.5))
    scene.add_geometry(plate, node_name="ground")
    house = trimesh.creation.box(extents=(6, 8, 5))
    scene.add_geometry(house, node_name="house 0", geom_name="house", transform=_moved(-10.0, 3.0, 2.5))
    scene.graph.update("house 1", geometry="house", matrix=_moved(10.0, 3.0, 2.5))
    scene.add_geometry(
        trimesh.creation.icosphere(subdivisions=2, radius=2.0), node_name="ball", transform=_moved(0, -9, 4)
    )
    if ending == ".gltf":
        return _gltf_of(sound(".glb"))
    content = (scene.to_geometry() if ending == ".ply" else scene).export(file_type=ending[1:])
    return content if isinstance(content, bytes) else content.encode()


def mutant(ending: str, number: int) -> bytes:
    """Mutant `number` of a format: one or two mutations, a pure function of both."""
    rng = stream(number, "mutant", ending)
    data = sound(ending)
    mutations = _MUTATIONS[ending]
    for _ in range(int(rng.integers(1, 3))):
        data = mutations[int(rng.integers(len(mutations)))](data, rng)
    return data


def read_all(files: list[Path]) -> Iterator[tuple[Path, str, str]]:
    """Read files in a limited child; yields each with "read", "refused" or "crashed", and what was said."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "scene.npz"
        tasks = [
            Task(str(k), "g", {"file": str(f), "up_axis": "z", "unit_m": 1.0, "out": str(out)})
            for k, f in enumerate(files)
        ]
        with Pool("scenegen.maps.own_scene.parse:worker", {}, 1, strikes=1, silence_s=120.0) as pool:
            for event in pool.run(tasks):
                path = files[int(event.task.key)]
                if isinstance(event, Done):
                    with np.load(out, allow_pickle=False) as arrays:
                        check(arrays, len(event.value["parts"]))
                    yield path, "read", str(dict(event.value["repairs"]))
                elif isinstance(event, Failed):
                    known = event.failure.exit_code is not None
                    yield path, "refused" if known else "crashed", event.failure.message


def check(arrays: Any, parts: int) -> None:
    """What was read is sound."""
    vertices, faces, part = arrays["vertices"], arrays["faces"], arrays["part"]
    assert np.isfinite(vertices).all() and np.abs(vertices).max() <= 1e4
    assert len(faces) and faces.min() >= 0 and faces.max() < len(vertices)
    assert len(part) == len(faces) and part.min() >= 0 and part.max() < parts
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert area.min() > 1e-7
    assert len(np.unique(np.sort(faces, axis=1), axis=0)) == len(faces)


def _moved(x: float, y: float, z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def _gltf_of(glb: bytes) -> bytes:
    """The same as text with its numbers inside."""
    import base64

    header, blob = _split(glb)
    header["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    return json.dumps(header).encode()


def _split(glb: bytes) -> tuple[dict[str, Any], bytes]:
    (size,) = struct.unpack_from("<I", glb, 12)
    return json.loads(glb[20 : 20 + size]), glb[28 + size :]


def _joined(header: Any, blob: bytes) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(blob), 0x004E4942) + blob
    return struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body


def _flip(data: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 5))):
        changed[int(rng.integers(len(changed)))] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def _cut(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: int(rng.integers(1, len(data) + 1))]


def _repeat(data: bytes, rng: np.random.Generator) -> bytes:
    start, end = sorted(rng.integers(0, len(data), 2).tolist())
    return data[:end] + data[start:end] + data[end:]


def _overwrite(data: bytes, rng: np.random.Generator) -> bytes:
    """Whole words of the numbers: NaN, infinity, indices out of range. The second half is mostly data."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 12))):
        at = int(rng.integers(len(data) // 3, max(len(data) - 4, len(data) // 3 + 1))) & ~3
        changed[at : at + 4] = _WORDS[int(rng.integers(len(_WORDS)))]
    return bytes(changed)


def _token(data: bytes, rng: np.random.Generator) -> bytes:
    words = data.split(b" ")
    for _ in range(int(rng.integers(1, 3))):
        words[int(rng.integers(len(words)))] = _TOKENS[int(rng.integers(len(_TOKENS)))]
    return b" ".join(words)


def _header_value(header: Any, rng: np.random.Generator) -> Any:
    """Replace one value anywhere in a tree by something it should not be."""
    places: list[tuple[Any, Any]] = []
    todo = [header]
    while todo:
        node = todo.pop()
        for key, child in node.items() if isinstance(node, dict) else enumerate(node):
            places.append((node, key))
            if isinstance(child, dict | list):
                todo.append(child)
    if places:
        node, key = places[int(rng.integers(len(places)))]
        node[key] = _HOSTILE[int(rng.integers(len(_HOSTILE)))]
    return header


def _glb_header(data: bytes, rng: np.random.Generator) -> bytes:
    try:
        header, blob = _split(data)
    except (ValueError, struct.error):
        return data
    return _joined(_header_value(header, rng), blob) if isinstance(header, dict) else data


def _gltf_header(data: bytes, rng: np.random.Generator) -> bytes:
    try:
        header = json.loads(data)
    except ValueError:
        return data
    return json.dumps(_header_value(header, rng)).encode() if isinstance(header, dict) else data


_MUTATIONS: dict[str, tuple[Mutation, ...]] = {
    ".glb": (_flip, _cut, _repeat, _overwrite, _glb_header, _glb_header, _glb_header),
    ".gltf": (_flip, _cut, _gltf_header, _gltf_header, _gltf_header),
    ".obj": (_flip, _cut, _repeat, _token, _token, _token),
    ".ply": (_flip, _cut, _repeat, _overwrite, _overwrite, _token),
}


def main(count: int) -> None:
    """Read `count` mutants of each format and say what became of them."""
    tally: dict[str, Counter[str]] = {}
    said: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for ending in ENDINGS:
            for number in range(count):
                path = Path(folder) / f"{number}{ending}"
                path.write_bytes(mutant(ending, number))
                files.append(path)
        for path, what, words in read_all(files):
            tally.setdefault(path.suffix, Counter())[what] += 1
            if what == "read" and words != "{}":
                tally[path.suffix]["of these repaired"] += 1
            if what == "crashed":
                print(f"crashed: {path.name}: {words}")
            if what == "refused":
                said[words.split("(")[0].split(":")[0][:60]] += 1
    for ending, counts in tally.items():
        print(f"{ending:6} {dict(counts)}")
    print("refused because it:", *(f"  {n:5} {words}" for words, n in said.most_common(25)), sep="\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 300)
