"""An independent road to the same day: cells, backward Euler in small steps, many days of spin-up."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.heat.balance import SAMPLES, Air, solve_day, surface_losses
from scenegen.heat.conduction import DAY_S, Stack

NAMES = ("asphalt_aged", "brick_red", "metal_roof_painted_mid", "grass_watered")
CELLS, SUBSTEPS, DAYS = 48, 5, 12
DT = DAY_S / SAMPLES / SUBSTEPS
DEEP_M = 1.2
"""Where endless ground is cut off: ten damping depths."""


def _slab(stack: Stack) -> tuple[np.ndarray, float, np.ndarray, float]:
    """One implicit step of a slab: its inverse matrix, answer of the outer cell to the outer flux, weight of the inner
    space on each cell, conductance from the outer cell's centre to the surface."""
    share = CELLS // len(stack.layers)
    width, k, capacity = [], [], []
    for layer in stack.layers:
        grading = np.geomspace(1.0, 12.0, share)
        width.append(min(layer.thickness_m, DEEP_M) * grading / grading.sum())
        k.append(np.full(share, layer.conductivity_WmK))
        capacity.append(width[-1] * layer.density_kgm3 * layer.heat_capacity_JkgK)
    half = np.concatenate(width) / (2.0 * np.concatenate(k))
    heat = np.concatenate(capacity)
    link = 1.0 / (half[:-1] + half[1:])
    back = 0.0 if stack.endless or stack.inner_Wm2K == 0.0 else 1.0 / (half[-1] + 1.0 / stack.inner_Wm2K)
    exchange = (
        np.diag(np.append(link, 0.0)) + np.diag(np.append(0.0, link)) - np.diag(link, 1) - np.diag(link, -1)
    )
    exchange[-1, -1] += back
    inverse = np.linalg.inv(np.eye(heat.size) + DT * exchange / heat[:, None])
    return inverse, DT / heat[0], inverse[:, -1] * DT * back / heat[-1], 1.0 / half[0]


@pytest.mark.slow
def test_finite_volumes_agree(handmade, july):
    p = handmade.roofs(NAMES, july)
    ours = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air).temperature_K
    slabs = [_slab(b.stack) for b in p.built]
    inverse = np.stack([s[0] for s in slabs])
    per_flux = np.stack([s[0][:, 0] * s[1] for s in slabs])
    from_space = np.stack([s[2] for s in slabs])
    outer = np.array([s[3] for s in slabs])
    conductance = outer / (1.0 + outer * per_flux[:, 0])

    fine = np.arange(SAMPLES * SUBSTEPS) / SUBSTEPS
    around = np.arange(SAMPLES + 1)
    absorbed = np.stack([np.interp(fine, around, np.append(a, a[0])) for a in p.absorbed])
    air_K = np.interp(fine, around, np.append(p.day.air.temperature_K, p.day.air.temperature_K[0]))
    space = np.stack([np.full(fine.size, b.inner_K) if np.isfinite(b.inner_K) else air_K for b in p.built])

    surface = ours.mean(axis=1)
    T = np.repeat(surface[:, None], inverse.shape[1], axis=1)
    trace = np.zeros((len(NAMES), fine.size))
    for step in range(DAYS * fine.size):
        now = (step + 1) % fine.size
        air = Air(air_K[now : now + 1], p.day.air.wind_mps, p.day.air.vapour_pressure_hPa)
        ahead = np.einsum("mij,mj->mi", inverse, T) + from_space * space[:, now, None]
        for _ in range(3):  # Newton on the four surface temperatures
            lost, slope = surface_losses(surface[:, None], p.skins, air)
            surplus = absorbed[:, now] - lost[:, 0] - conductance * (surface - ahead[:, 0])
            surface = surface + surplus / (slope[:, 0] + conductance)
        T = ahead + per_flux * (conductance * (surface - ahead[:, 0]))[:, None]
        trace[:, now] = surface

    difference = trace[:, ::SUBSTEPS] - ours
    assert np.abs(difference).max() < 0.3
    assert np.sqrt((difference**2).mean(axis=1)).max() < 0.12
