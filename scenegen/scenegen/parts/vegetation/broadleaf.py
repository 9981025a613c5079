"""Recursive branching inside a crown outline: trunk, limbs, branches, twigs, and leaf sprays on branches and twigs.

The parameters are those of Weber and Penn 1995, "Creation and rendering of realistic trees" (SIGGRAPH, doi:
10.1145/218380.218427): how many children of each order, their angles, lengths and curvature; lengths end at the
outline, so that the species' silhouette comes out whatever the branches do.
"""

from __future__ import annotations

import numpy as np

from scenegen.parts.vegetation.branches import GOLDEN_RAD, Branches, aside, sprout, unit
from scenegen.parts.vegetation.cards import FACES, SPRAY_AREA, middles, moved_by, sprays
from scenegen.parts.vegetation.growth import Grown, Plan
from scenegen.parts.vegetation.habits import Broadleaf
from scenegen.parts.vegetation.mesh import NOTHING, Mesh, merged
from scenegen.parts.vegetation.outline import pull_inside, room, side_area
from scenegen.parts.vegetation.tubes import tubes

_TRUNK_FACES, _LIMB_FACES, _BRANCH_FACES, _TWIG_FACES = 84, 24, 9, 3
"""Triangles of one of each, as `tubes` makes them."""
_WOOD_SHARE = 0.38
"""Of the triangles of a tree in leaf."""
_SMALL_FACES = 900
"""Below so many triangles, tubes have fewer sides."""
_FOOT = -0.03
_SHOWS_TWIGS = 0.75
"""Share of the foliage below which twigs are seen, and drawn."""
_HIDDEN_SHARE, _HIDDEN_AREA = 0.2, 1.7
"""Share of the sprays that fill the inside of a crown, and their area against the others: nobody sees their edges."""
_REACH = 0.96
_LOWEST_LEAF = 0.4
"""How far down leaves hang, in heights of the outline's base."""
_STRAY = 0.4
"""How far sprays stand off their twigs, in their lengths: petioles and side shoots too fine to draw."""
_TWIG_RADIUS = (0.0016, 0.0006)


def grow(species: Broadleaf, plan: Plan, rng: np.random.Generator) -> Grown:
    """Grow one tree of about unit height."""
    bare = plan.in_leaf < _SHOWS_TWIGS
    faces = plan.faces / (1.0 + plan.in_leaf * bare)
    wood = _richness(species, faces, bare)
    small = faces < _SMALL_FACES
    trunk = _trunk(species, 5 if small else 8, rng)
    limbs = _limbs(species, trunk, wood[0], rng)
    branches = _branches(species, limbs, wood[1], rng)
    twigs = _twigs(species, branches, wood[2], rng)
    trunk, limbs, branches, twigs = _filling(species, (trunk, limbs, branches, twigs))
    thin = [tubes(_coarse(branches, bare), 3, True)]
    if bare:
        thin.append(tubes(twigs, 3, True))
    body, boughs, shoots = (
        tubes(trunk, 5 if small else 7, False),
        tubes(limbs, 3 if small else 4, True),
        merged(thin),
    )
    left = round(faces) - (len(body) + len(boughs) + len(shoots)) * (not bare)
    leaves = NOTHING
    if plan.in_leaf > 0.0:
        leaves = _foliage(species, branches, twigs, max(left, 160) // FACES, plan.in_leaf, rng)
    return Grown(body, boughs, shoots, leaves)


def _richness(species: Broadleaf, faces: float, bare: bool) -> tuple[int, int, int]:
    """Limbs of the tree, branches of a limb, twigs of a branch: as many as the triangles for wood allow."""
    w = species.wood
    room_for = faces if bare else _WOOD_SHARE * faces
    for share in np.geomspace(1.2, 0.25, 26):
        limbs, branches = max(4, round(w.limbs * share)), max(2, round(w.branches * share))
        twigs = max(2, round(w.twigs * share))
        each = branches * (_BRANCH_FACES + _TWIG_FACES * twigs if bare else _TWIG_FACES)
        if w.stems * _TRUNK_FACES + limbs * (_LIMB_FACES + each) <= room_for:
            break
    return limbs, branches, twigs


def _trunk(species: Broadleaf, nodes: int, rng: np.random.Generator) -> Branches:
    w = species.wood
    lean = rng.normal(0.0, 0.03 + 0.1 * w.crooked, (w.stems, 3))
    if w.stems > 1:
        around = 2 * np.pi * np.arange(w.stems) / w.stems + rng.uniform(0, 2 * np.pi)
        spread = np.column_stack([np.cos(around), np.sin(around), np.zeros(w.stems)])
        lean += 0.42 * spread
        start = 0.8 * w.girth * spread + np.array([0.0, 0.0, _FOOT])
    else:
        start = np.array([[0.0, 0.0, _FOOT]])
    lean[:, 2] = 1.0
    reach = np.full(w.stems, w.leader - _FOOT)
    thick = np.full(w.stems, w.girth / np.sqrt(w.stems))
    tip = thick * (0.12 if w.leader > 0.75 else 0.4)
    trunk = sprout(start, unit(lean), reach, (thick, tip), nodes, 0.35, 0.25 * w.crooked, rng)
    flare = 1.0 + 0.45 * np.exp(-np.maximum(trunk.points[..., 2], 0.0) / 0.025)
    return Branches(trunk.points, trunk.radius * flare)


def _limbs(species: Broadleaf, trunk: Branches, count: int, rng: np.random.Generator) -> Branches:
    w, outline = species.wood, species.outline
    k = np.arange(count)
    rank = (k + rng.uniform(0.2, 0.8, count)) / count
    lowest = max(outline.base * 0.82, 0.02)
    height = lowest + (w.leader - lowest) * rank**0.85
    stem = k % w.stems
    start, along, thick = trunk.at(stem, (height - _FOOT) / (w.leader - _FOOT))
    tilt = np.deg2rad(w.limb_angle_deg[0] + (w.limb_angle_deg[1] - w.limb_angle_deg[0]) * rank)
    tilt *= rng.uniform(0.85, 1.15, count)
    turn = GOLDEN_RAD * k + rng.normal(0.0, 0.25, count)
    heading = aside(0.4 * along + np.array([0.0, 0.0, 0.6]), tilt, turn)
    if w.stems > 1:
        outward = start * np.array([1.0, 1.0, 0.0])
        heading = unit(heading + 3.0 * outward)
    inner = pull_inside(outline, start)
    length = (np.linalg.norm(start - inner, axis=1) + room(outline, inner, heading)) * rng.uniform(
        0.80, 0.97, count
    )
    base = np.minimum(0.72 * thick, 0.10 * length + 0.003)
    limbs = sprout(start, heading, length, (base, 0.22 * base), 5, w.upturn, w.crooked, rng)
    return _bounded(species, limbs)


def _branches(species: Broadleaf, limbs: Branches, each: int, rng: np.random.Generator) -> Branches:
    w = species.wood
    parent = np.repeat(np.arange(len(limbs.points)), each)
    slot = np.tile(np.arange(each), len(limbs.points))
    t = 0.22 + 0.78 * (slot + rng.uniform(0.1, 0.9, len(slot))) / each
    start, along, thick = limbs.at(parent, t)
    angle = np.deg2rad(w.branch_angle_deg) * rng.uniform(0.7, 1.25, len(t)) * (1.15 - 0.5 * t)
    heading = aside(along, angle, GOLDEN_RAD * slot + rng.uniform(0, 2 * np.pi, len(t)))
    wanted = limbs.length()[parent] * (0.62 - 0.32 * t) * rng.uniform(0.7, 1.2, len(t))
    length = np.minimum(np.maximum(wanted, 0.05), 0.95 * room(species.outline, start, heading))
    base = np.minimum(0.7 * thick, 0.02 * length + 0.0018)
    tip = np.minimum(0.4 * base, _TWIG_RADIUS[0])
    return _bounded(species, sprout(start, heading, length, (base, tip), 3, w.twig_upturn, w.crooked, rng))


def _twigs(species: Broadleaf, branches: Branches, each: int, rng: np.random.Generator) -> Branches:
    w = species.wood
    count = len(branches.points)
    parent = np.repeat(np.arange(count), each)
    slot = np.tile(np.arange(each), count)
    t = 0.25 + 0.75 * (slot + rng.uniform(0.2, 1.0, len(slot))) / each
    start, along, thick = branches.at(parent, t)
    angle = np.deg2rad(0.9 * w.branch_angle_deg) * rng.uniform(0.6, 1.3, len(t))
    heading = aside(along, angle, 2.6 * slot + rng.uniform(0, 2 * np.pi, len(t)))
    heading = unit(heading + np.array([0.0, 0.0, 0.6 * w.twig_upturn]))
    length = np.maximum(branches.length()[parent] * (0.75 - 0.3 * t), 0.03) * rng.uniform(0.7, 1.3, len(t))
    base = np.minimum(0.8 * thick, _TWIG_RADIUS[0])
    tip = np.full(len(t), _TWIG_RADIUS[1])
    return _bounded(species, sprout(start, heading, length, (base, tip), 2, 0.0, 0.0, rng))


def _bounded(species: Broadleaf, branches: Branches) -> Branches:
    """The same with all nodes but the first inside the outline."""
    points = branches.points.copy()
    shape = points[:, 1:].shape
    points[:, 1:] = pull_inside(species.outline, points[:, 1:].reshape(-1, 3)).reshape(shape)
    step = np.linalg.norm(np.diff(points, axis=1), axis=2)
    stuck = step < 1e-4
    points[:, 1:][stuck] += np.array([0.0, 0.0, -2e-3])
    return Branches(points, branches.radius)


def _filling(species: Broadleaf, orders: tuple[Branches, ...]) -> tuple[Branches, ...]:
    """Orders of branches stretched until twigs reach the top and the sides of the outline."""
    outline, tips = species.outline, orders[-1].points.reshape(-1, 3)
    tall = (_REACH - outline.base) / (tips[:, 2].max() - outline.base)
    wide = _REACH * outline.radius / np.hypot(tips[:, 0], tips[:, 1]).max()
    found = []
    for order in orders:
        points = order.points * np.array([wide, wide, 1.0])
        above = np.maximum(points[..., 2] - outline.base, 0.0)
        points[..., 2] += (tall - 1.0) * above
        found.append(Branches(points, order.radius))
    return tuple(found)


def _coarse(branches: Branches, bare: bool) -> Branches:
    """In leaf, branches are straight: one segment each."""
    return branches if bare else Branches(branches.points[:, [0, -1]], branches.radius[:, [0, -1]])


def _foliage(
    species: Broadleaf,
    branches: Branches,
    twigs: Branches,
    count: int,
    in_leaf: float,
    rng: np.random.Generator,
) -> Mesh:
    """Sprays along twigs, and larger hidden ones along branches; falling foliage leaves twig by twig."""
    leaf, outline = species.leaves, species.outline
    hidden = int(_HIDDEN_SHARE * count)
    outer = count - hidden
    on_twig = np.arange(outer) % len(twigs.points)
    t = rng.uniform(0.1, 1.05, outer) ** (1.0 - 0.8 * leaf.clumped)
    base, along, _ = twigs.at(on_twig, t)
    on_branch = np.arange(hidden) % len(branches.points)
    base_in, along_in, _ = branches.at(on_branch, rng.uniform(0.0, 0.6, hidden))
    base, along = np.concatenate([base, base_in]), np.concatenate([along, along_in])
    size = np.concatenate([np.full(outer, 1.0), np.full(hidden, _HIDDEN_AREA)]) * rng.uniform(0.5, 1.5, count)
    size *= leaf.cover * side_area(outline) / size.sum()
    length = np.sqrt(size * leaf.slender / SPRAY_AREA)
    outward = unit(base - np.array([0.0, 0.0, 0.5 * (outline.base + 1.0)]))
    spin = unit(rng.normal(size=(count, 3)))
    heading = unit(along + 0.8 * spin + 0.4 * outward + np.array([0.0, 0.0, -1.2 * leaf.droop]))
    facing = 0.8 * unit(rng.normal(size=(count, 3))) + outward + np.array([0.0, 0.0, 0.6])
    stray = (1.0 - leaf.clumped) * rng.normal(size=(count, 3))
    if in_leaf < 1.0:
        owner = np.concatenate([on_twig, on_branch])
        keep = rng.uniform(size=len(twigs.points))[owner % len(twigs.points)] < in_leaf
        base, heading, facing, length, stray = (a[keep] for a in (base, heading, facing, length, stray))
    made = sprays(
        base + length[:, None] * (_STRAY * stray - 0.3 * heading), heading, facing, length, leaf.slender
    )
    middle = middles(made)
    inside = moved_by(made, pull_inside(outline, middle, 0.95) - middle)
    lowest = np.array([-np.inf, -np.inf, _LOWEST_LEAF * outline.base])
    return Mesh(np.maximum(inside.vertices, lowest), inside.faces)
