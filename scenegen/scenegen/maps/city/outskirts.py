"""Beyond the detailed city: fields, roads that lead out, plain buildings and groves up to the horizon."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Bool, Float64

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come, rectangles, roads_out
from scenegen.geometry.standing import mesh_heights
from scenegen.geometry.template import place
from scenegen.maps.city.streets import StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.countryside import countryside
from scenegen.parts.vegetation.grove import grove

FAR_M = 2600.0
_ROAD_HALF_M = 5.0


def road_lines(plan: StreetPlan) -> np.ndarray:
    """Centre lines of the roads that leave the city."""
    return roads_out(plan.exits, FAR_M, sway_m=60.0, bend_m=420.0, tuck_m=3.0, points=40)


def far_regions(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> list[Region]:
    """Land around the city; the first region covers everything."""
    grass = shop.palette.pick("grass_dry", rng)
    half = np.abs(plan.outline.bounds).max()
    count = 60
    angle, reach = rng.uniform(0, 2 * np.pi, count), half + 1800.0 * rng.uniform(0.02, 1.0, count)
    centre = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]
    length = rng.uniform(60.0, 130.0, count) * (reach / half)
    fields = rectangles(centre, length, length * rng.uniform(0.4, 0.9, count), rng.uniform(0, np.pi, count))
    roads = shapely.buffer(road_lines(plan), _ROAD_HALF_M, cap_style="flat")
    land = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)
    return countryside(land, grass, plan.outline.buffer(25.0), fields, roads, land.buffer(-20.0), shop, rng)


@dataclass(frozen=True, eq=False)
class FarPlan:
    """Plain buildings and groves around the city.

    Attributes
    ----------
    centre : float64 (things, 2)
        [m].
    size : float64 (things, 3)
        Length, width and height [m].
    heading_rad : float64 (things,)
    built : bool (things,)
        Buildings; the rest are groves.
    """

    centre: Float64[np.ndarray, "things 2"]
    size: Float64[np.ndarray, "things 3"]
    heading_rad: Float64[np.ndarray, "things"]
    built: Bool[np.ndarray, "things"]

    def outlines(self) -> np.ndarray:
        """Rectangles around everything, an array of shapely polygons."""
        width = np.where(self.built, self.size[:, 1], self.size[:, 0])
        return rectangles(self.centre, self.size[:, 0], width, self.heading_rad)


def plan_far(plan: StreetPlan, rng: np.random.Generator) -> FarPlan:
    """Plain buildings and groves, denser towards the city; they thin out with distance."""
    half = float(np.abs(plan.outline.bounds).max())
    count = 1200
    angle = rng.uniform(0.0, 2 * np.pi, count)
    reach = half * 0.85 + 1900.0 * rng.uniform(0.0, 1.0, count) ** 1.7
    centre = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]
    heading = (
        0.5 * np.pi * np.round(rng.uniform(0, 1, count))
        + 0.6 * np.sin(2 * angle)
        + rng.normal(0, 0.06, count)
    )
    built = rng.uniform(size=count) < 0.55
    length = np.where(built, rng.uniform(11.0, 34.0, count), rng.uniform(14.0, 40.0, count))
    width = np.where(built, rng.uniform(9.0, 18.0, count), length * rng.uniform(0.5, 1.0, count))
    shapes = rectangles(centre, length + 5.0, width + 5.0, heading)
    roads = shapely.buffer(road_lines(plan), _ROAD_HALF_M + 2.0, cap_style="flat")
    taken = np.array([plan.outline.buffer(8.0), *roads], dtype=object)
    keep = clear_of(shapes, taken) & first_come(shapes)
    size = np.column_stack(
        [length, width, np.where(rng.uniform(size=count) < 0.08, 28.0, rng.uniform(5.0, 15.0, count))]
    )
    return FarPlan(centre[keep], size[keep], heading[keep], built[keep])


def far_objects(
    far: FarPlan, plan: StreetPlan, ground: Part, shop: CityWorkshop, rng: np.random.Generator
) -> list[Part]:
    """What was planned, as parts that stand on the mesh of the ground."""
    shapely.prepare(plan.outline)
    inside = shapely.contains_xy(plan.outline, ground.vertices[:, :2])
    height = mesh_heights(ground, ~inside[ground.faces].all(axis=1), far.centre, shop.relief)
    centre = np.column_stack([far.centre, height])
    built, grown = far.built, ~far.built
    return [
        _plain_buildings(centre[built], far.size[built], far.heading_rad[built], shop, rng),
        _groves(centre[grown], far.size[grown], shop, rng),
    ]


def _plain_buildings(
    centre: np.ndarray,
    size: np.ndarray,
    heading: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Part:
    names = ("stucco_render", "brick_red", "concrete_wall", "concrete_wall")
    wall = np.array([shop.palette.pick(names[int(k)], rng) for k in rng.integers(0, 4, len(centre))])
    roofs = np.array(
        [
            shop.palette.pick(("clay_roof_tile", "bitumen_felt_roof")[int(k)], rng)
            for k in rng.integers(0, 2, len(centre))
        ]
    )
    model = Modeller()
    model.box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0), 0, Semantic.WALL)
    template = model.finish()
    roof = template.vertices[template.faces][..., 2].min(axis=1) > 0.5
    template = replace(
        template,
        slot=np.where(roof, 1, 0),
        semantic=np.where(roof, int(Semantic.ROOF), int(Semantic.WALL)),
    )
    base = centre - np.array([0.0, 0.0, 1.5])
    owner = shop.builder.new_objects(len(centre)) + np.arange(len(centre))
    scale = size + np.array([0, 0, 1.5])
    return place(template, base, heading, scale, np.column_stack([wall, roofs]), owner)


def _groves(
    centre: np.ndarray,
    size: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Part:
    skin = np.array([[shop.palette.pick("tree_crown", rng)] for _ in range(len(centre))], np.int64).reshape(
        -1, 1
    )
    scale = np.column_stack([size[:, 0], size[:, 0], rng.uniform(7.0, 13.0, len(centre))])
    first = shop.builder.new_objects(len(centre))
    heading = rng.uniform(0.0, 2 * np.pi, len(centre))
    return place(grove(rng), centre, heading, scale, skin, first + np.arange(len(centre)))
