"""The city: streets, blocks, buildings, ground, greenery, traffic and the land around, from one generator."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import draw_relief, sample_height_field
from scenegen.maps.city.districts import lay_out
from scenegen.maps.city.greenery import build_trees
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.shells import build_shells
from scenegen.maps.city.streets import draw_streets
from scenegen.maps.city.terrain import build_terrain
from scenegen.maps.city.traffic import build_traffic
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World


def build_city(knobs: CityKnobs, rng: np.random.Generator) -> World:
    """Build one city.

    Parameters
    ----------
    knobs : CityKnobs
    rng : numpy.random.Generator
        The only source of randomness; each subsystem gets a child of its own.
    """
    street_rng, relief_rng, palette_rng, layout_rng, ground_rng, shell_rng, car_rng, tree_rng = rng.spawn(8)
    extent = rng.uniform(*knobs.extent_m)
    palette, builder = PaletteBuilder(palette_rng), GeometryBuilder()
    plan = draw_streets(extent, knobs.block_area_m2, rng.uniform(*knobs.street_bend_m), street_rng)
    relief = draw_relief(relief_rng, relief_rng.uniform(*knobs.relief_m), (280.0, 900.0))
    layout = lay_out(plan, knobs, relief, palette, builder, layout_rng)
    builder.add(build_terrain(plan, layout, relief, palette, builder, ground_rng))
    builder.add(build_shells(layout.buildings, shell_rng))
    cars, car_shapes = build_traffic(plan, knobs, relief, palette, builder, car_rng)
    builder.add(*cars)
    trees, tree_count = build_trees(layout, knobs, relief, palette, builder, tree_rng)
    builder.add(*trees)
    merged = builder.merge()
    half = extent / 2
    return World(
        map="city",
        mesh=merged.mesh,
        face_surface=merged.face_surface,
        face_semantic=merged.face_semantic,
        face_object=merged.face_object,
        corner_site=merged.corner_site,
        sites=merged.sites,
        palette=palette.surfaces(),
        ground=sample_height_field(relief, half + 60.0, 5.0),
        flight_box_m=((-half, -half, 0.0), (half, half, knobs.flight_ceiling_m)),
        counts=(
            ("blocks", len(layout.blocks)),
            ("buildings", len(layout.buildings)),
            ("cars", len(car_shapes)),
            ("trees", tree_count),
        ),
    )
