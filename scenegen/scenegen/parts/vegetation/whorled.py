"""Conifers: whorls of drooping boughs around a straight trunk; every bough carries a fan of hanging sprays."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.parts.vegetation.branches import Branches, sprout, unit
from scenegen.parts.vegetation.growth import Grown, Plan
from scenegen.parts.vegetation.habits import Whorled
from scenegen.parts.vegetation.mesh import NOTHING, Mesh
from scenegen.parts.vegetation.outline import half_width
from scenegen.parts.vegetation.tubes import tubes

_FULL_FACES = 2400
_FOOT = -0.03
_LOWEST = 0.03
UPWARD = np.array([0.0, 0.0, 1.0])


def grow(species: Whorled, plan: Plan, rng: np.random.Generator) -> Grown:
    """Grow one conifer of unit height."""
    q = (plan.faces / _FULL_FACES) ** (1.0 / 3.0)
    whorls = max(7, round(species.whorls * q))
    each = max(5, round(species.boughs * q))
    trunk = sprout(
        np.array([[0.0, 0.0, _FOOT]]), np.array([[0.0, 0.0, 1.0]]), np.array([0.985 - _FOOT]),
        (np.array([species.girth]), np.array([0.0012])), 5, 0.0, 0.004, rng,
    )  # fmt: skip
    boughs = _boughs(species, trunk, whorls, each, rng)
    inner = Branches(boughs.points[:, :2], boughs.radius[:, :2])
    body, limbs = tubes(trunk, 5, True), tubes(inner, 3, True)
    left = plan.faces - len(body) - len(limbs)
    return Grown(body, limbs, NOTHING, _needles(species, boughs, whorls, left, rng))


def _boughs(species: Whorled, trunk: Branches, whorls: int, each: int, rng: np.random.Generator) -> Branches:
    base = species.outline.base
    level = base + (0.97 - base) * ((np.arange(whorls) + 0.25) / whorls) ** 0.9
    z = np.repeat(level, each) + rng.normal(0.0, 0.012, whorls * each)
    z = np.clip(z, base, 0.975)
    rank = (z - base) / (1.0 - base)
    turn = np.tile(2 * np.pi * np.arange(each) / each, whorls) + np.repeat(
        rng.uniform(0, 2 * np.pi, whorls), each
    )
    turn += rng.normal(0.0, 0.15, len(z))
    low, high = species.rise_deg
    rise = np.deg2rad(low + (high - low) * rank**1.5 + rng.normal(0.0, 4.0, len(z)))
    reach = half_width(species.outline, z) * rng.uniform(0.78, 1.0, len(z))
    start, _, thick = trunk.at(np.zeros(len(z), np.int64), (z - _FOOT) / (0.985 - _FOOT))
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(len(z))])
    s = np.linspace(0.0, 1.0, 4)
    bow = species.sag * (1.0 - rank)[:, None] * (1.3 * s**3 - 1.6 * s**2)
    lift = np.tan(rise)[:, None] * s + bow
    points = start[:, None, :] + reach[:, None, None] * (
        out[:, None, :] * s[:, None] + UPWARD * lift[..., None]
    )
    points[..., 2] = np.clip(points[..., 2], 1.1 * _LOWEST, 0.99)
    radius = np.minimum(0.35 * thick, 0.006)[:, None] * (1 - 0.85 * s)
    return Branches(points, radius)


def _needles(species: Whorled, boughs: Branches, whorls: int, faces: int, rng: np.random.Generator) -> Mesh:
    """Sprays beside each bough, curtains below it, one at its tip; and the leading shoot of the tree."""
    pairs = max(2, (faces // len(boughs.points) - 1) // 3)
    corners = np.concatenate(
        [*(_beside(species, boughs, pairs, hand, rng) for hand in (1.0, -1.0)),
         _below(species, boughs, pairs, (1.0 - species.outline.base) / whorls, rng), _tips(boughs, rng)]
    )  # fmt: skip
    flat = corners.reshape(-1, 3)
    flat[:, 2] = np.clip(flat[:, 2], _LOWEST, 0.995)
    reach = np.maximum(1.05 * half_width(species.outline, flat[:, 2]), 0.012)
    flat[:, :2] *= np.minimum(1.0, reach / np.maximum(np.hypot(*flat[:, :2].T), 1e-9))[:, None]
    return Mesh.of(np.concatenate([flat, _leader()]).reshape(-1, 3, 3))


def _stations(
    boughs: Branches, each: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Place, direction, share of the length and length of the bough, for stations along every bough."""
    bough = np.repeat(np.arange(len(boughs.points)), each)
    rank = np.tile((np.arange(each) + 0.5) / each, len(boughs.points))
    t = np.clip(0.08 + 0.86 * rank + rng.normal(0.0, 0.25 / each, len(rank)), 0.02, 0.96)
    base, along, _ = boughs.at(bough, t)
    return base, along, t, boughs.length()[bough]


def _beside(
    species: Whorled, boughs: Branches, each: int, hand: float, rng: np.random.Generator
) -> Float64[np.ndarray, "sprays 3 3"]:
    base, along, t, length = _stations(boughs, each, rng)
    level = unit(along * np.array([1.0, 1.0, 0.0]))
    side = hand * np.column_stack([-level[:, 1], level[:, 0], np.zeros(len(t))])
    width = (length * (0.50 - 0.30 * t) + 0.012) * rng.uniform(0.7, 1.25, len(t))
    hang = 0.5 * species.curtain * rng.uniform(0.6, 1.5, len(t))
    tip = base + width[:, None] * unit(side + 0.8 * along - hang[:, None] * UPWARD)
    half = (0.62 / each * length + 0.006)[:, None] * along
    return np.stack([base - half, base + half, tip], axis=1)


def _below(
    species: Whorled, boughs: Branches, each: int, spacing: float, rng: np.random.Generator
) -> Float64[np.ndarray, "sprays 3 3"]:
    """Curtains, as long as whorls are apart: hanging in spruces, short in firs."""
    base, along, t, length = _stations(boughs, each, rng)
    drop = spacing * species.curtain * (1.1 - 0.5 * t) * rng.uniform(0.6, 1.5, len(t))
    drop *= np.clip(1.5 - base[:, 2], 0.5, 1.0)
    sway = 0.35 * rng.normal(size=base.shape) * np.array([1.0, 1.0, 0.0])
    tip = base + drop[:, None] * (sway + 0.3 * along - UPWARD)
    half = (0.8 / each * length + 0.004)[:, None] * along
    return np.stack([base - half, base + half, tip], axis=1)


def _tips(boughs: Branches, rng: np.random.Generator) -> Float64[np.ndarray, "boughs 3 3"]:
    """A narrow triangle at the end of each bough."""
    base, along, _ = boughs.at(np.arange(len(boughs.points)), np.full(len(boughs.points), 0.7))
    length = 0.40 * boughs.length()[:, None] * rng.uniform(0.8, 1.15, (len(base), 1))
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(base))])
    return np.stack(
        [base - 0.28 * length * across, base + 0.28 * length * across, base + length * along], axis=1
    )


def _leader() -> Float64[np.ndarray, "corners 3"]:
    """The leading shoot, three triangles that end at the top of the tree."""
    turn = 2 * np.pi * np.arange(3) / 3
    low = 0.012 * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(3)]) + 0.93 * UPWARD
    return np.stack([low, np.roll(low, -1, axis=0), np.broadcast_to(UPWARD, (3, 3))], axis=1).reshape(-1, 3)
