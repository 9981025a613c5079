"""Small worlds with known answers: a closed room, a plate under the sky, a city of plain boxes.

The self-check, the physics tests and the benchmarks render these; each is built of rectangular patches whose radiance
or geometry has a closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32, Float64, UInt32

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.materials.material import Surface
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.thermal_state import ThermalState
from scenegen.world import HeightField, Sites, TriangleMesh, World

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Patch:
    """A rectangle cut into cells; its front side is ``along x up`` (right-handed).

    Attributes
    ----------
    corner, along, up : tuple of float
        Lower corner and the two edge vectors [m].
    cells : (int, int)
        Cells along each edge; every grid vertex is a site.
    surface : int
        Palette index.
    semantic : Semantic
    object : int
        Instance id, >= 1.
    """

    corner: Vector
    along: Vector
    up: Vector
    cells: tuple[int, int]
    surface: int
    semantic: Semantic
    object: int


def world_of(name: str, patches: list[Patch], palette: tuple[Surface, ...]) -> World:
    """Merge patches into a world; sites are the grid vertices of each patch."""
    parts = [_grid(p) for p in patches]
    first = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = np.concatenate([faces + offset for (_, faces), offset in zip(parts, first, strict=False)]).astype(
        np.uint32
    )
    face_count, site_count = [len(f) for _, f in parts], [len(v) for v, _ in parts]
    surface = np.array([p.surface for p in patches], np.uint16)
    objects = np.array([p.object for p in patches], np.uint32)
    normal = np.array([_normal(p) for p in patches], np.float32)
    area = np.array([_area(p) / n for p, n in zip(patches, site_count, strict=True)], np.float32)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return World(
        map=name,
        mesh=TriangleMesh(vertices, faces),
        face_surface=np.repeat(surface, face_count),
        face_semantic=np.repeat(np.array([p.semantic for p in patches], np.uint8), face_count),
        face_object=np.repeat(objects, face_count),
        corner_site=faces.copy(),
        sites=Sites(
            position=vertices.copy(),
            normal=np.repeat(normal, site_count, axis=0),
            area=np.repeat(area, site_count),
            surface=np.repeat(surface, site_count),
            object=np.repeat(objects, site_count),
            standoff=np.full(len(vertices), 2e-3, np.float32),
        ),
        palette=palette,
        ground=HeightField(
            (float(low[0]), float(low[1])), float(high[0] - low[0]), np.zeros((2, 2), np.float32)
        ),
        flight_box_m=(_vector(low), _vector(high)),
        counts=(("patches", len(patches)),),
    )


def box(
    low: Vector, high: Vector, cell_m: float, surface: int, semantic: Semantic, instance: int
) -> list[Patch]:
    """Outward-facing sides and top of an axis-aligned box; it has no floor."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
    edges: list[tuple[Vector, Vector, Vector]] = [
        ((x0, y0, z0), (dx, 0, 0), (0, 0, dz)),
        ((x1, y0, z0), (0, dy, 0), (0, 0, dz)),
        ((x1, y1, z0), (-dx, 0, 0), (0, 0, dz)),
        ((x0, y1, z0), (0, -dy, 0), (0, 0, dz)),
        ((x0, y0, z1), (dx, 0, 0), (0, dy, 0)),
    ]
    return [Patch(c, a, u, _cells(a, u, cell_m), surface, semantic, instance) for c, a, u in edges]


def room(palette: tuple[Surface, ...], size_m: float = 10.0, cell_m: float = 2.5) -> World:
    """Closed cubic room seen from inside, its six sides (and a pillar) taking the palette's surfaces in turn."""
    s = size_m
    edges: list[tuple[Vector, Vector, Vector]] = [
        ((0, 0, 0), (s, 0, 0), (0, s, 0)),
        ((0, 0, s), (0, s, 0), (s, 0, 0)),
        ((0, 0, 0), (0, 0, s), (s, 0, 0)),
        ((0, s, 0), (s, 0, 0), (0, 0, s)),
        ((0, 0, 0), (0, s, 0), (0, 0, s)),
        ((s, 0, 0), (0, 0, s), (0, s, 0)),
    ]
    n = len(palette)
    sides = [
        Patch(c, a, u, _cells(a, u, cell_m), k % n, Semantic.WALL, 1 + k) for k, (c, a, u) in enumerate(edges)
    ]
    pillar = box((0.6 * s, 0.6 * s, 0.0), (0.7 * s, 0.7 * s, 0.5 * s), cell_m, 6 % n, Semantic.POLE, 7)
    return world_of("room", sides + pillar, palette)


def plate(surface: Surface, size_m: float = 200.0, cells: int = 4) -> World:
    """Horizontal square at z = 0, centred on the origin, under the open sky."""
    half = size_m / 2
    sheet = Patch((-half, -half, 0), (size_m, 0, 0), (0, size_m, 0), (cells, cells), 0, Semantic.ROAD, 1)
    return world_of("plate", [sheet], (surface,))


def box_city(
    palette: tuple[Surface, Surface, Surface, Surface],
    rng: np.random.Generator,
    blocks: int = 16,
    cell_m: float = 2.4,
) -> World:
    """City of plain boxes with window strips, about 540,000 triangles at the default cell.

    Parameters
    ----------
    palette : four surfaces
        Ground, wall, roof, window.
    rng : numpy.random.Generator
    blocks : int
        Blocks along each side; 50 m each.
    cell_m : float
        Largest mesh cell.
    """
    pitch, half = 50.0, blocks * 25.0
    ground = Patch(
        (-half, -half, 0),
        (2 * half, 0, 0),
        (0, 2 * half, 0),
        (2 * round(half / cell_m),) * 2,
        0,
        Semantic.ROAD,
        1,
    )
    patches, instance = [ground], 2
    for i, j in np.ndindex(blocks, blocks):
        width, depth = rng.uniform(18.0, 38.0, 2)
        height = float(rng.choice([9.0, 12.0, 15.0, 21.0, 36.0, 60.0], p=[0.2, 0.25, 0.2, 0.2, 0.1, 0.05]))
        x, y = -half + pitch * i + (pitch - width) / 2, -half + pitch * j + (pitch - depth) / 2
        body = box((x, y, 0.0), (x + width, y + depth, height), cell_m, 1, Semantic.WALL, instance)
        roof = body.pop()
        patches += [*body, replace(roof, surface=2, semantic=Semantic.ROOF)]
        patches += _windows(body, instance)
        instance += 1
    return world_of("box_city", patches, palette)


def uniform_state(world: World, temperature_K: float, atmosphere: Atmosphere) -> ThermalState:
    """State in which every site has one temperature and nothing is textured."""
    return ThermalState(
        season=Season(latitude_deg=40.0, month=7, day=15),
        hour=12.0,
        weather=_weather(atmosphere),
        atmosphere=atmosphere,
        temperature_K=np.full(len(world.sites.area), temperature_K, np.float32),
        texture_K=np.zeros(len(world.palette), np.float32),
        moving_K=np.full(sum(len(m.body.site_position) for m in world.movers), temperature_K, np.float32),
    )


def looking(position_m: Vector, heading_deg: float, pitch_deg: float) -> Float64[np.ndarray, "4 4"]:
    """`world_from_camera` of a level camera: heading counter-clockwise from east, pitch upwards."""
    heading, pitch = math.radians(heading_deg), math.radians(pitch_deg)
    level = math.cos(pitch)
    forward = np.array([math.cos(heading) * level, math.sin(heading) * level, math.sin(pitch)])
    right = np.array([math.sin(heading), -math.cos(heading), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=-1)
    pose[:3, 3] = position_m
    return pose


def _weather(air: Atmosphere) -> Weather:
    """A day without amplitude whose air is the given one; dew point by the Magnus formula [K]."""
    ratio = math.log(max(air.vapour_pressure_hPa, 1e-3) / 6.112)
    dew_point = min(273.15 + 243.5 * ratio / (17.67 - ratio), air.air_K)
    return Weather(air.air_K, 0.0, 14.0, dew_point, 3.0, air.cloud_fraction, 3.0, air.visibility_km)


def _windows(walls: list[Patch], instance: int) -> list[Patch]:
    """One window strip per storey of 3 m, 5 cm in front of each wall, 1.5 m high."""
    strips = []
    for wall in walls:
        along, normal, height = np.array(wall.along), _normal(wall), wall.up[2]
        for floor in range(int(height // 3)):
            corner = np.array(wall.corner) + 0.1 * along + 0.05 * normal + (0, 0, 3.0 * floor + 0.9)
            x, y, z = map(float, corner)
            edge: Vector = (0.8 * wall.along[0], 0.8 * wall.along[1], 0.0)
            strips.append(Patch((x, y, z), edge, (0, 0, 1.5), (4, 1), 3, Semantic.WINDOW, instance))
    return strips


def _vector(values: Float32[np.ndarray, "3"]) -> Vector:
    x, y, z = map(float, values)
    return x, y, z


def _cells(along: Vector, up: Vector, cell_m: float) -> tuple[int, int]:
    return max(1, round(math.hypot(*along) / cell_m)), max(1, round(math.hypot(*up) / cell_m))


def _normal(patch: Patch) -> Float32[np.ndarray, "3"]:
    n = np.cross(np.array(patch.along, float), np.array(patch.up, float))
    return np.asarray(n / np.linalg.norm(n), np.float32)


def _area(patch: Patch) -> float:
    return float(np.linalg.norm(np.cross(np.array(patch.along, float), np.array(patch.up, float))))


def _grid(patch: Patch) -> tuple[Float32[np.ndarray, "vertices 3"], UInt32[np.ndarray, "faces 3"]]:
    """Vertices row by row along the first edge, two triangles a cell, counter-clockwise from the front."""
    n, m = patch.cells
    s, t = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1))
    vertices = (
        np.array(patch.corner, float)
        + s[..., None] * np.array(patch.along)
        + t[..., None] * np.array(patch.up)
    )
    j, i = (a.ravel() for a in np.mgrid[0:m, 0:n])
    a = j * (n + 1) + i
    b, c, d = a + 1, a + n + 1, a + n + 2
    faces = np.stack([np.stack([a, b, d], -1), np.stack([a, d, c], -1)], 1).reshape(-1, 3)
    return vertices.reshape(-1, 3).astype(np.float32), faces.astype(np.uint32)
