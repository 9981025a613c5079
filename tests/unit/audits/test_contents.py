"""What is seen in frames composed by hand."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.radiometry.planck import band_radiance
from scenegen_datasets.audits.contents import ContentsAudit
from scenegen_datasets.audits.geometry import rays
from scenegen_render.sensor.scale import radiance_to_counts


def test_classes_sky_and_height_over_a_meadow(staged: ModuleType) -> None:
    pitched = staged.pose()
    turn = np.deg2rad(20.0)  # the camera looks down by 20 degrees, 10 m above the ground
    pitched[:3, :3] = pitched[:3, :3] @ [
        [1, 0, 0],
        [0, np.cos(turn), np.sin(turn)],
        [0, -np.sin(turn), np.cos(turn)],
    ]
    down = (rays(staged.K, staged.SHAPE) @ pitched[:3, :3].T)[..., 2]
    depth = np.where(down < -1e-3, 10.0 / np.maximum(-down, 1e-3), np.inf).astype(np.float32)
    meadow = np.isfinite(depth)
    heat = np.where(meadow, 290.0, 240.0)
    still = replace(
        staged.wall().now,
        world_from_camera=pitched,
        depth=depth,
        semantic=np.where(meadow, Semantic.GRASS, Semantic.SKY).astype(np.uint8),
        counts=radiance_to_counts(band_radiance(heat, (8.0, 14.0)).astype(np.float32), staged.SCALE),
    )
    audit = ContentsAudit(np.random.default_rng(6))
    audit.see(staged.step(still, staged.wall().next))
    found = audit.result()
    assert found.height_m.median == pytest.approx(10.0, abs=1e-3)
    assert found.sky_share.median == pytest.approx(1.0 - meadow.mean())
    shares = {share.name: share.pixels for share in found.classes}
    assert shares == {"grass": pytest.approx(meadow.mean()), "sky": pytest.approx(1.0 - meadow.mean())}
    assert found.contrast_K.median == pytest.approx(50.0, abs=0.05)
    assert found.surface_contrast_K.median == pytest.approx(0.0, abs=0.02)
    assert found.verdict.level == "note"  # a meadow of one temperature holds nothing to see by


def test_a_textured_wall_has_contrast(staged: ModuleType) -> None:
    audit = ContentsAudit(np.random.default_rng(6))
    audit.see(staged.wall())
    found = audit.result()
    assert found.verdict.level == "fine" and found.sky_share.median == 0.0
    assert found.flow_px.median == pytest.approx(1.6, abs=1e-3)
    assert found.height_m.median is None  # a wall is no ground
