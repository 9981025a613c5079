"""From what a parser returned to triangles one can trust: checked, welded, counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.foundation.errors import InputError
from scenegen.geometry.builder import MIN_FACE_AREA_M2
from scenegen.geometry.part import face_areas
from scenegen.maps.own_scene.limits import MAX_REACH_M, MIN_SIZE_M
from scenegen.maps.own_scene.raw import Names, RawScene

_KEPT_WHERE_IT_IS_M = 2000.0
"""A scene that lies within this distance of its origin keeps its coordinates."""

_ABSURD = 1e12


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles of one part as the parser returned them: nothing is certain but the number of columns.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
    faces : int64 (faces, 3)
    matrix : float64 (4, 4)
        To the frame of the file.
    names : Names
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    matrix: Float64[np.ndarray, "4 4"]
    names: Names


@dataclass(frozen=True, eq=False)
class Joined:
    """All parts in one, in the frame of the file; every index exists.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
    faces : int64 (faces, 3)
    part : int64 (faces,)
    parts : tuple of Names
    missing : int
        Faces dropped because a corner does not exist.
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    part: Int64[np.ndarray, "faces"]
    parts: tuple[Names, ...]
    missing: int


def join(soups: Sequence[Soup]) -> Joined:
    """Put the parts into one frame; drops faces whose corners do not exist.

    Raises
    ------
    InputError
        If there is no triangle at all, or an array is not what it should be.
    """
    vertices, faces, part = [], [], []
    first = missing = 0
    for k, soup in enumerate(soups):
        exists = ((soup.faces >= 0) & (soup.faces < len(soup.vertices))).all(axis=1)
        missing += int((~exists).sum())
        faces.append(soup.faces[exists] + first)
        part.append(np.full(int(exists.sum()), k, np.int64))
        vertices.append(soup.vertices @ soup.matrix[:3, :3].T + soup.matrix[:3, 3])
        first += len(soup.vertices)
    if not soups or not sum(map(len, faces)):
        raise InputError("holds no sound triangle")
    return Joined(
        np.concatenate(vertices),
        np.concatenate(faces),
        np.concatenate(part),
        tuple(s.names for s in soups),
        missing,
    )


def repair(joined: Joined, ignored: int, up_axis: str, unit_m: float) -> RawScene:
    """Turn a scene upright, into metres and near the origin; weld it and drop what cannot be rendered.

    Parameters
    ----------
    joined : Joined
    ignored : int
        Lines and points that were not read, for the counts.
    up_axis : str
        "y" or "z".
    unit_m : float
        [m] per unit of the file.

    Raises
    ------
    InputError
        If too little is left, or the scene's size makes no sense.
    """
    finite = (np.abs(joined.vertices) < _ABSURD).all(axis=1)  # false for NaN
    keep = finite[joined.faces].all(axis=1)
    broken = joined.missing + int((~keep).sum())
    if broken > keep.sum():
        raise InputError(
            f"is broken: {broken:,} of its {joined.missing + len(keep):,} triangles have corners that are missing "
            "or not finite"
        )
    vertices, shift = _placed(joined.vertices, joined.faces[keep], up_axis, unit_m)
    faces, part = joined.faces[keep], joined.part[keep]
    vertices, faces = weld(vertices, faces)
    large = _has_area(vertices, faces)
    single = np.zeros(len(faces), bool)
    single[large] = _first_of_equals(faces[large])
    if not single.any():
        raise InputError("holds no triangle with an area")
    used, compact = np.unique(faces[single], return_inverse=True)
    counts = (
        ("lines and points ignored", ignored),
        ("faces dropped: corner missing", joined.missing),
        ("faces dropped: not finite", int((~keep).sum())),
        ("faces dropped: no area", int((~large).sum())),
        ("faces dropped: duplicate", int((large & ~single).sum())),
    )
    return RawScene(
        vertices=vertices[used],
        faces=compact.reshape(-1, 3).astype(np.int64),
        part=part[single],
        parts=joined.parts,
        repairs=tuple(entry for entry in counts if entry[1]),
        shift_m=shift,
    )


def _placed(
    vertices: Float64[np.ndarray, "vertices 3"],
    faces: Int64[np.ndarray, "faces 3"],
    up_axis: str,
    unit_m: float,
) -> tuple[Float64[np.ndarray, "vertices 3"], tuple[float, float]]:
    """ENU metres, shifted by whole metres if the scene lies far from its origin."""
    enu = (
        vertices * unit_m
        if up_axis == "z"
        else np.stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]], axis=1) * unit_m
    )
    seen = enu[faces.ravel()]
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = float((high - low).max())
    if not MIN_SIZE_M <= size <= 2.0 * MAX_REACH_M:
        raise InputError(
            f"is {size:,.4g} m large; a scene has {MIN_SIZE_M:g} m to {2 * MAX_REACH_M:,.0f} m: is unit_m right?"
        )
    shift = np.zeros(3)
    if max(np.abs(low[:2]).max(), np.abs(high[:2]).max()) > _KEPT_WHERE_IT_IS_M:
        shift[:2] = np.rint((low[:2] + high[:2]) / 2)
    if max(abs(low[2]), abs(high[2])) > 2.0 * MAX_REACH_M:
        raise InputError(f"lies {low[2]:,.0f} m high; move it down to its own ground")
    return enu - shift, (float(shift[0]), float(shift[1]))


def weld(
    vertices: Float64[np.ndarray, "vertices 3"], faces: Int64[np.ndarray, "faces 3"]
) -> tuple[Float64[np.ndarray, "welded 3"], Int64[np.ndarray, "faces 3"]]:
    """Merge vertices that are equal as float32, which is what the renderer sees; unused ones may stay.

    One sort per coordinate: ten times faster than sorting rows.
    """
    corner = np.unique(faces)
    single = vertices[corner].astype(np.float32) + np.float32(0.0)  # no -0.0
    code = np.zeros(len(corner), np.int64)
    for axis in range(3):
        values, rank = np.unique(single[:, axis], return_inverse=True)
        _, code = np.unique(code * len(values) + rank.ravel(), return_inverse=True)
        code = code.ravel()
    _, first = np.unique(code, return_index=True)
    index = np.zeros(len(vertices), np.int64)
    index[corner] = code
    return single[first].astype(np.float64), index[faces]


def _has_area(
    vertices: Float64[np.ndarray, "vertices 3"], faces: Int64[np.ndarray, "faces 3"]
) -> Bool[np.ndarray, "faces"]:
    return np.asarray(face_areas(vertices, faces) > MIN_FACE_AREA_M2)


def _first_of_equals(faces: Int64[np.ndarray, "faces 3"]) -> Bool[np.ndarray, "faces"]:
    """Faces whose three corners, in whatever order, no earlier face has: two in one place would flicker."""
    corners = np.sort(faces, axis=1)
    _, rank = np.unique(corners[:, 0] * (int(faces.max(initial=0)) + 1) + corners[:, 1], return_inverse=True)
    code = rank.ravel() * (int(faces.max(initial=0)) + 1) + corners[:, 2]
    _, first = np.unique(code, return_index=True)
    mask = np.zeros(len(faces), bool)
    mask[first] = True
    return mask
