"""Settling a lot: a house that fits, its driveway and path, its garden; and the floors all houses stand on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from scenegen.buildings.detached.body import Body, Home, HomeStyle, Role, Top, outline
from scenegen.buildings.detached.draw import (
    Traits,
    draw_bodies,
    draw_chimneys,
    draw_dormers,
    draw_home_style,
    draw_hut,
)
from scenegen.buildings.lots import Lot
from scenegen.climate.climatology import normals
from scenegen.maps.neighborhood.garden import UNDER_M, plan_garden
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop

FLOOR_M = 0.16
"""Floors above the graded ground around the house [m]."""

_SIDE_M, _SETBACK_M = 1.4, (4.5, 7.5)
"""Free strip inside a lot's borders, and how far houses stand back from the street."""
_ATTEMPTS = 6
"""Houses drawn for a lot, each smaller than the last, before it stays a meadow."""
_BELOW_GROUND_M = 0.7
"""How far walls go on below the lowest ground around them."""


@dataclass(frozen=True, eq=False)
class Settler:
    """What all parcels of a world have in common: its own values, drawn from the knobs.

    Attributes
    ----------
    shop : NeighborhoodWorkshop
    plan : StreetPlan
    built, modern, two_storeys, garages, unheated, dry, pools, sheds : float
        Shares, see `NeighborhoodKnobs`.
    cold_glass : int
        Palette index of the panes of unheated rooms.
    """

    shop: NeighborhoodWorkshop
    plan: StreetPlan
    built: float
    modern: float
    two_storeys: float
    garages: float
    unheated: float
    dry: float
    pools: float
    sheds: float
    cold_glass: int

    @staticmethod
    def draw(shop: NeighborhoodWorkshop, plan: StreetPlan, rng: np.random.Generator) -> Settler:
        """Draw the world's own values."""
        knobs = shop.knobs
        spans = (
            knobs.built_share, knobs.modern_share, knobs.two_storey_share, knobs.garage_share,
            knobs.unheated_share, knobs.dry_lawn_share, knobs.pool_share, knobs.shed_share,
        )  # fmt: skip
        built, modern, two, garages, unheated, dry, pools, sheds = (
            float(rng.uniform(*span)) for span in spans
        )
        shop.palette.variants("window_glass", 3)
        room_K = max(normals(shop.season).expected_C + 273.15 + 2.0, 278.0)
        cold = shop.palette.special("window_glass", "unheated", interior_K=room_K)
        return Settler(shop, plan, built, modern, two, garages, unheated, dry, pools, sheds, cold)

    def settle(self, lot: Lot, age: float, rng: np.random.Generator) -> Parcel:
        """Build on a lot.

        Parameters
        ----------
        lot : Lot
        age : float
            0 to 1, smooth over the plane: neighbours are of about the same age.
        rng : numpy.random.Generator
        """
        dry = bool(rng.uniform() < self.dry)
        if rng.uniform() > self.built or lot.frontage_m < 9.0:
            return Parcel(lot, dry)
        modern = age + rng.normal(0.0, 0.12) < self.modern
        traits = Traits(
            modern,
            2 if rng.uniform() < self.two_storeys else 1,
            bool(rng.uniform() < self.garages),
            self.unheated,
        )
        style = draw_home_style(traits, self.cold_glass, self.shop.palette, rng)
        bodies = self._fit(lot, traits, style, rng)
        if not bodies:
            return Parcel(lot, dry)
        parcel = Parcel(lot, dry, bodies, style=style)
        parcel = replace(parcel, solid=parcel.world(outline(bodies)))
        parcel = self._approaches(parcel, rng)
        hut = (
            draw_hut((rng.uniform(2.2, 3.6), rng.uniform(2.0, 3.0)), style, rng)
            if rng.uniform() < self.sheds
            else None
        )
        garden, hut = plan_garden(
            lot, bodies, hut, parcel.driveway, self.plan, bool(rng.uniform() < self.pools), rng
        )
        hut_style = None
        if hut is not None:
            skins = self.shop.palette
            wall = skins.pick("wood_siding", rng)
            roof = skins.pick(
                ("asphalt_shingle", "bitumen_felt_roof", "metal_roof_painted_mid")[int(rng.integers(3))], rng
            )
            hut_style = replace(
                style, wall=wall, gable=wall, roof=roof, door=wall, glass=self.cold_glass, blank_share=0.8,
                storey_m=2.0, unheated_share=1.0,
            )  # fmt: skip
        return replace(parcel, garden=garden, hut=hut, hut_style=hut_style)

    def _fit(self, lot: Lot, traits: Traits, style: HomeStyle, rng: np.random.Generator) -> tuple[Body, ...]:
        """Bodies in the lot's frame, inside its borders; empty if nothing sensible fits."""
        room = lot.local().buffer(-_SIDE_M, join_style="mitre")
        if room.is_empty or room.geom_type != "Polygon":
            return ()
        shapely.prepare(room)
        x0, _, x1, y1 = room.bounds
        middle = lot.frontage_m / 2
        for attempt in range(_ATTEMPTS):
            shrink = 1.0 - 0.07 * attempt
            drawn = draw_bodies(
                replace(traits, garage=traits.garage and attempt < 4),
                style,
                (x1 - x0) * min(shrink, 0.94),
                rng,
            )
            mirror = bool(rng.uniform() < 0.5)
            bodies = tuple(b.moved(0.0, 0.0, mirror) for b in drawn)
            shape = outline(bodies)
            left, low, right, _ = shape.bounds
            back = rng.uniform(*_SETBACK_M) - low
            dx, dy = (
                g.ravel()
                for g in np.meshgrid(
                    np.array(
                        [
                            middle,
                            x0 - left + 0.05,
                            x1 - right - 0.05,
                            (x0 + x1 - left - right) / 2,
                            middle - 2,
                            middle + 2,
                        ]
                    ),
                    np.array([back, back - 1.3, back + 2.0, back + 4.0, 3.2 - low]),
                    indexing="ij",
                )
            )
            ring = shapely.get_coordinates(shape.exterior)
            moved = ring[None] + np.column_stack([dx, dy])[:, None, :]
            fits = shapely.contains(room, shapely.polygons(moved)) & (dy + shape.bounds[3] < y1)
            if fits.any():
                k = int(np.argmax(fits))
                return tuple(b.moved(float(dx[k]), float(dy[k]), False) for b in bodies)
        return ()

    def _approaches(self, parcel: Parcel, rng: np.random.Generator) -> Parcel:
        """Driveway to the garage (or beside the house), path to the front door."""
        reach = self.plan.public_m + 1.5
        span = _gate(parcel.bodies)
        driveway, bays = None, np.zeros((0, 3))
        if span is not None:
            a, b, y = span
            driveway = self._strip(parcel, a, b, y, reach)
            rows = []
            lanes = [(a + b) / 2] if b - a < 4.6 else [a + 0.27 * (b - a), b - 0.27 * (b - a)]
            for x in lanes:
                for k in range(int(max(y - 0.6, 0.0) // 5.3)):
                    xy = parcel.lot.world(np.array([[x, y - 3.0 - 5.3 * k]]))[0]
                    turn = np.pi if rng.uniform() < 0.4 else 0.0
                    rows.append([*xy, parcel.lot.heading_rad + 0.5 * np.pi + turn])
            bays = np.array(rows).reshape(-1, 3)
        door = parcel.bodies[0].entrance_m
        path = None
        if door is not None:
            porch = [b for b in parcel.bodies if b.role is Role.SHELTER and b.top is Top.SHED]
            y = porch[0].y0_m if porch else parcel.bodies[0].y0_m
            half = rng.uniform(0.5, 0.75)
            if span is None or door + half < span[0] - 0.3 or door - half > span[1] + 0.3:
                path = self._strip(parcel, door - half, door + half, y, self.plan.walk_m * 0.5)
        return replace(parcel, driveway=driveway, path=path, bays=bays)

    def _strip(self, parcel: Parcel, a: float, b: float, y: float, reach: float) -> shapely.Polygon | None:
        """Paving between two abscissae from the house (a little below it) to the street; outside the carriageway."""
        strip = parcel.world(shapely.box(a, -reach, b, y + UNDER_M))
        rest = strip.difference(self.plan.carriageway)
        near = shapely.Point(parcel.lot.world(np.array([[(a + b) / 2, y - 0.3]]))[0])
        pieces = [p for p in shapely.get_parts(rest) if p.geom_type == "Polygon" and p.dwithin(near, 0.1)]
        return pieces[0] if pieces and pieces[0].area > 2.0 else None


def _gate(bodies: tuple[Body, ...]) -> tuple[float, float, float] | None:
    """Span along x of the garage door or carport, and its y."""
    for body in bodies:
        for _, a, b in body.doors:
            return a, b, body.y0_m
        if body.role is Role.SHELTER and body.top is Top.FLAT:
            return body.x0_m + 0.3, body.x1_m - 0.3, body.y1_m - 0.4
    return None


def homes_of(parcels: list[Parcel], shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Home]:
    """Houses and sheds with floors just above the graded ground; instance ids are drawn here."""
    homes = []
    for parcel in parcels:
        if parcel.style is None or parcel.solid is None:
            continue
        main = parcel.bodies[0]
        floor, depth = _stand(parcel.solid, shop)
        homes.append(
            Home(
                shop.builder.new_objects(), parcel.style, parcel.bodies, parcel.lot, floor, depth,
                draw_chimneys(main, rng), draw_dormers(main, parcel.bodies, rng),
            )
        )  # fmt: skip
        if parcel.hut is not None and parcel.hut_style is not None:
            floor, depth = _stand(parcel.world(outline((parcel.hut,))), shop)
            none = np.zeros((0, 3))
            homes.append(
                Home(
                    shop.builder.new_objects(),
                    parcel.hut_style,
                    (parcel.hut,),
                    parcel.lot,
                    floor - 0.08,
                    depth,
                    none,
                    none,
                )
            )
    return homes


def _stand(solid: shapely.Polygon, shop: NeighborhoodWorkshop) -> tuple[float, float]:
    """Floor just above the highest ground at the walls, and the depth of the foundation."""
    ground = shop.relief(shapely.get_coordinates(shapely.segmentize(solid.exterior, 2.0))) + KERB_M
    floor = float(ground.max()) + FLOOR_M
    return floor, floor - float(ground.min()) + _BELOW_GROUND_M
