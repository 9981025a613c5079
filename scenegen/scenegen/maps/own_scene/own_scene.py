"""A world from a scene file: read, named, cut, given sites, ground and airspace."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.geometry.builder import GeometryBuilder, MergedGeometry
from scenegen.geometry.part import Part, face_areas, face_normals
from scenegen.maps.own_scene.detail import Detail
from scenegen.maps.own_scene.facets import smooth_facets
from scenegen.maps.own_scene.identity import content_hash, sidecar_path
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.naming import Meaning, meanings
from scenegen.maps.own_scene.raw import RawScene
from scenegen.maps.own_scene.reading import read_scene
from scenegen.maps.own_scene.sidecar import Prescribed, Sidecar, read_sidecar
from scenegen.maps.own_scene.sites import Skin, place_sites
from scenegen.maps.own_scene.subdivide import subdivide
from scenegen.maps.own_scene.terrain import ground_field
from scenegen.materials.material import Build, Surface
from scenegen.materials.palette import PaletteBuilder
from scenegen.materials.table import material
from scenegen.world import HeightField, World

FIRST_USER_MATERIAL = 1000
"""Material ids from here on are the user's: prescribed surfaces, by temperature, then emissivity."""

SPACING_M = 2.5
"""Longest edge of a triangle where there is detail, hence distance of sites on a large surface [m]."""

_MOST_CUT = 500_000
"""Triangles that cutting may add; a larger scene is cut more coarsely."""


@dataclass(frozen=True, eq=False)
class Described:
    """A scene and what its sidecar says of it, checked against each other.

    Attributes
    ----------
    raw : RawScene
    sidecar : Sidecar
    meaning : tuple of Meaning
        One for each part.
    """

    raw: RawScene
    sidecar: Sidecar
    meaning: tuple[Meaning, ...]


def describe(scene: OwnScene) -> Described:
    """Read a scene and its sidecar.

    Raises
    ------
    InputError
        For anything that is wrong with either, in one line; also if they are not those the recipe was made with.
    """
    if not scene.file:
        raise InputError("the file of this scene is not known; give its path with --map")
    path = Path(scene.file)
    if scene.sha256 not in ("", content_hash(path)):
        raise InputError(
            f"{path}: it or its sidecar has changed since this dataset was begun; choose another --out"
        )
    where = sidecar_path(path)
    sidecar = read_sidecar(where)
    raw = read_scene(path, sidecar)
    return Described(raw, sidecar, meanings(raw.parts, sidecar, path, where))


def build_own_scene(name: str, scene: OwnScene, season: Season, rng: np.random.Generator) -> World:
    """Build the world of a scene file.

    Parameters
    ----------
    name : str
        What the dataset calls it.
    scene : OwnScene
    season : Season
        Without influence: what stands in the file stands there all year.
    rng : numpy.random.Generator
        Draws the variants of the materials, and nothing else.
    """
    described = describe(scene)
    raw = described.raw
    palette, part_surface = _palette(described, rng)
    semantic = np.array([m.semantic for m in described.meaning], np.int64)
    owner = np.unique([part.object for part in raw.parts], return_inverse=True)[1].ravel() + 1
    merged = _merge(raw, part_surface, semantic, owner)
    vertices, faces = merged.mesh.vertices.astype(np.float64), merged.mesh.faces.astype(np.int64)
    ground = ground_field(vertices, faces, face_normals(vertices, faces)[0], merged.face_semantic)
    return merged.world(
        map=name,
        palette=palette,
        ground=ground,
        flight_box_m=_flight_box(vertices, ground, described.sidecar, raw.shift_m),
        counts=_counts(raw),
    )


def _palette(
    described: Described, rng: np.random.Generator
) -> tuple[tuple[Surface, ...], Int64[np.ndarray, "parts"]]:
    """Surfaces of the world, and which one each part has: a variant of its material, or a prescribed one."""
    variants_rng, choice_rng = rng.spawn(2)
    builder = PaletteBuilder(variants_rng)
    drawn = [
        builder.pick(m.made_of, choice_rng) if isinstance(m.made_of, str) else -1 for m in described.meaning
    ]
    given = sorted(
        {m.made_of for m in described.meaning if isinstance(m.made_of, Prescribed)},
        key=lambda p: (p.temperature_K, p.emissivity),
    )
    fixed = {choice: len(builder.surfaces()) + k for k, choice in enumerate(given)}
    index = [
        fixed[m.made_of] if isinstance(m.made_of, Prescribed) else d
        for m, d in zip(described.meaning, drawn, strict=True)
    ]
    surfaces = (*builder.surfaces(), *(_prescribed(choice, k) for k, choice in enumerate(given)))
    return surfaces, np.array(index, np.int64)


def _prescribed(choice: Prescribed, number: int) -> Surface:
    """A matt surface that keeps its temperature, without texture."""
    row = replace(
        material("concrete_wall"),
        id=FIRST_USER_MATERIAL + number,
        name=f"prescribed_{choice.temperature_K:g}K_{choice.emissivity:g}",
        emissivity=choice.emissivity,
        emissivity_range=(choice.emissivity, choice.emissivity),
        build=Build.SOLID,
        texture_K=0.0,
        source="sidecar of the scene",
    )
    return Surface(row, choice.emissivity, row.solar_absorptance, prescribed_K=choice.temperature_K)


def _merge(
    raw: RawScene,
    part_surface: Int64[np.ndarray, "parts"],
    semantic: Int64[np.ndarray, "parts"],
    owner: Int64[np.ndarray, "parts"],
) -> MergedGeometry:
    """Cut the triangles, place the sites and put everything into the form of a world."""
    normal, area = face_normals(raw.vertices, raw.faces)
    group = owner[raw.part] * (int(part_surface.max()) + 1) + part_surface[raw.part]
    facet = smooth_facets(raw.faces, normal, group)
    vertices, faces, parent, spacing = _cut(raw, Detail.of(raw.vertices, raw.faces, area, facet))
    skin = Skin(vertices, faces, normal[parent], face_areas(vertices, faces), facet[parent], group[parent])
    placed = place_sites(skin, spacing)
    part = raw.part[parent]
    builder = GeometryBuilder()
    builder.add(
        Part(
            vertices=vertices,
            faces=faces,
            surface=part_surface[part],
            semantic=semantic[part],
            object=owner[part],
            corner_site=placed.corner_site,
            site_position=placed.position,
            site_normal=placed.normal,
            site_standoff=placed.standoff,
        )
    )
    return builder.merge()


def _cut(
    raw: RawScene, detail: Detail
) -> tuple[
    Float64[np.ndarray, "vertices 3"], Int64[np.ndarray, "faces 3"], Int64[np.ndarray, "faces"], float
]:
    """Cut the triangles as finely as the budget allows: vertices, faces, the face each comes from, spacing [m]."""
    most = len(raw.faces) + _MOST_CUT
    for spacing, doubled_after in _fineness():
        longest = partial(detail.longest_m, spacing_m=spacing, doubled_after_m=doubled_after)
        cut = subdivide(raw.vertices, raw.faces, longest, most)
        if cut is not None:
            return *cut, spacing
    raise AssertionError("edges of any length are never cut")


def _fineness() -> Iterator[tuple[float, float]]:
    """Spacing and distance that doubles it [m], from fine to coarse: the open ground gives way first."""
    yield from ((SPACING_M, doubled_after) for doubled_after in (20.0, 5.0, 1.25))
    spacing = SPACING_M
    while True:
        yield spacing, 0.3
        spacing *= 1.3


def _flight_box(
    vertices: Float64[np.ndarray, "vertices 3"],
    ground: HeightField,
    sidecar: Sidecar,
    shift_m: tuple[float, float],
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """The sides of the scene, a little inwards, or those of the sidecar inside them; from the lowest ground up."""
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    margin = np.minimum(5.0, 0.05 * (high - low))
    low, high = low + margin, high - margin
    if sidecar.flight_area_m is not None:
        west, south, east, north = sidecar.flight_area_m
        low = np.maximum(low, np.array([west, south]) - shift_m)
        high = np.minimum(high, np.array([east, north]) - shift_m)
        if (high - low).min() < 1.0:
            raise InputError(f"flight_area_m {list(sidecar.flight_area_m)} lies outside the scene")
    floor = float(ground.height_m.min())
    return (float(low[0]), float(low[1]), floor), (
        float(high[0]),
        float(high[1]),
        floor + sidecar.flight_ceiling_m,
    )


def _counts(raw: RawScene) -> tuple[tuple[str, int], ...]:
    east, north = raw.shift_m
    shift = (
        (("m taken off east", round(east)), ("m taken off north", round(north)))
        if (east, north) != (0, 0)
        else ()
    )
    return (("parts", len(raw.parts)), ("triangles in the file", len(raw.faces)), *raw.repairs, *shift)
