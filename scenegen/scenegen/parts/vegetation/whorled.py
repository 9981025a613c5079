"""Conifers: whorls of drooping boughs around a straight trunk; every bough carries a fan of hanging sprays."""

from __future__ import annotations

import numpy as np

from scenegen.parts.vegetation.branches import Branches, sprout, unit
from scenegen.parts.vegetation.growth import Grown, Plan
from scenegen.parts.vegetation.outline import half_width
from scenegen.parts.vegetation.species import Whorled
from scenegen.parts.vegetation.tubes import Mesh, tubes

_FULL_FACES = 2400
_FOOT = -0.03


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
    body, limbs = tubes(trunk, 5, True), tubes(boughs, 3, True)
    sprays = int((plan.faces - len(body[1])) / len(boughs.points) - 9)
    return Grown(body, _thin(limbs, boughs), _sprays(species, boughs, max(8, sprays), rng))


def _thin(limbs: Mesh, boughs: Branches) -> Mesh:
    """Only the bare inner part of each bough, as far as its first sprays: the rest is hidden in needles."""
    per = len(limbs[1]) // len(boughs.points)
    kept = limbs[1].reshape(len(boughs.points), per, 3)[:, :6].reshape(-1, 3)
    used, index = np.unique(kept, return_inverse=True)
    return limbs[0][used], index.reshape(-1, 3)


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
        out[:, None, :] * s[:, None] + np.array([0.0, 0.0, 1.0]) * lift[..., None]
    )
    points[..., 2] = np.clip(points[..., 2], 0.012, 0.99)
    radius = np.minimum(0.35 * thick, 0.006)[:, None] * (1 - 0.85 * s)
    return Branches(points, radius)


def _sprays(species: Whorled, boughs: Branches, each: int, rng: np.random.Generator) -> Mesh:
    """Triangles in pairs along each bough, pointing out and forward, the ends hanging; and one at the tip."""
    count, pairs = len(boughs.points), max(3, (each - 1) // 2)
    bough = np.repeat(np.arange(count), 2 * pairs)
    side = np.tile(np.repeat([1.0, -1.0], pairs), count)
    rank = np.tile(np.tile((np.arange(pairs) + 0.4) / pairs, 2), count)
    t = np.clip(0.12 + 0.86 * rank + rng.normal(0.0, 0.03, len(rank)), 0.0, 0.98)
    base, along, _ = boughs.at(bough, t)
    length = boughs.length()[bough]
    level = unit(along * np.array([1.0, 1.0, 0.0]))
    left = np.column_stack([-level[:, 1], level[:, 0], np.zeros(len(t))]) * side[:, None]
    width = length * (0.52 - 0.36 * t) * rng.uniform(0.75, 1.25, len(t))
    down = np.array([0.0, 0.0, -1.0])
    hang = species.curtain + 0.25 * rng.uniform(size=len(t))
    tip = base + width[:, None] * unit(left + 0.75 * along + hang[:, None] * down)
    foot = 0.95 / pairs * length[:, None] * along
    near, far = base - 0.55 * foot, base + 0.85 * foot
    near[:, 2] -= 0.15 * width * hang
    ends = _tips(boughs, rng)
    corners = np.concatenate([np.stack([near, np.where(side[:, None] > 0, far, tip),
                                        np.where(side[:, None] > 0, tip, far)], axis=1), ends])  # fmt: skip
    flat = corners.reshape(-1, 3)
    reach = np.maximum(half_width(species.outline, flat[:, 2]), 0.004)
    flat[:, :2] *= np.minimum(1.0, 1.06 * reach / np.maximum(np.hypot(*flat[:, :2].T), 1e-9))[:, None]
    flat[:, 2] = np.maximum(flat[:, 2], 0.01)
    return flat, np.arange(len(flat)).reshape(-1, 3)


def _tips(boughs: Branches, rng: np.random.Generator) -> np.ndarray:
    """One narrow triangle at the end of each bough, and a leading shoot."""
    base, along, _ = boughs.at(np.arange(len(boughs.points)), np.full(len(boughs.points), 0.72))
    length = 0.42 * boughs.length()[:, None] * rng.uniform(0.8, 1.1, (len(base), 1))
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(base))])
    tips = np.stack(
        [base - 0.2 * length * across, base + 0.2 * length * across, base + length * along], axis=1
    )
    turn = 2 * np.pi * np.arange(3) / 3
    out = 0.012 * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(3)])
    top = np.array([0.0, 0.0, 1.0])
    low = np.array([0.0, 0.0, 0.93])
    leader = np.stack([low + out, low + np.roll(out, -1, axis=0), np.broadcast_to(top, (3, 3))], axis=1)
    return np.concatenate([tips, leader])
