from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from scenegen.foundation.rng import stream
from scenegen.radiometry.planck import band_radiance
from scenegen_render.camera import Camera
from scenegen_render.sensor.agc import percentile_agc, plateau_agc
from scenegen_render.sensor.flock import Flock
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.scale import (
    MAX_COUNT,
    CountScale,
    counts_to_brightness_K,
    counts_to_radiance,
    radiance_to_counts,
)
from scenegen_render.sensor.sense import Microbolometer, sense

BAND = (8.0, 14.0)
SCALES = [CountScale(233.0, 423.0, BAND, kind) for kind in ("radiance", "temperature")]
CAMERA = Camera.from_fov(40, 30, 45.0)


def _clip(frames: int) -> list[np.ndarray]:
    T = stream(7, "scene").uniform(260.0, 330.0, (frames, 30, 40))
    return list(band_radiance(T, BAND).astype(np.float32))


def _counts(frames: int = 5, seed: int = 1, **knobs: object) -> np.ndarray:
    readings = sense(_clip(frames), np.arange(frames) / 30.0, CAMERA, SensorKnobs(**knobs), stream(seed))
    return np.stack([r.counts for r in readings])


@pytest.mark.parametrize("scale", SCALES, ids=["radiance", "temperature"])
def test_scale_ends(scale: CountScale) -> None:
    ends = band_radiance(np.array([233.0, 423.0]), BAND).astype(np.float32)
    assert radiance_to_counts(ends, scale).tolist() == [0, MAX_COUNT]
    beyond = band_radiance(np.array([200.0, 480.0]), BAND).astype(np.float32)
    assert radiance_to_counts(beyond, scale).tolist() == [0, MAX_COUNT]


@pytest.mark.parametrize("scale", SCALES, ids=["radiance", "temperature"])
def test_every_count_survives_a_round_trip(scale: CountScale) -> None:
    counts = np.arange(MAX_COUNT + 1, dtype=np.uint16)
    np.testing.assert_array_equal(radiance_to_counts(counts_to_radiance(counts, scale), scale), counts)
    assert np.all(np.diff(counts_to_brightness_K(counts, scale)) > 0)


def test_round_trip_error_is_half_a_count_of_radiance() -> None:
    scale = SCALES[0]
    low, high = scale.ends
    L = stream(2).uniform(low, high, 100_000).astype(np.float32)
    error = np.abs(counts_to_radiance(radiance_to_counts(L, scale), scale) - L)
    assert float(error.max()) <= 0.5 * (high - low) / MAX_COUNT * (1 + 1e-3) + 1e-5


def test_temperature_linear_counts_are_a_ruler_in_kelvin() -> None:
    scale = SCALES[1]
    T = np.linspace(233.0, 423.0, 50_001)
    counts = radiance_to_counts(band_radiance(T, BAND).astype(np.float32), scale)
    ruler = np.rint((T - 233.0) / 190.0 * MAX_COUNT)
    assert np.mean(counts != ruler) < 0.02  # float32 radiance decides a few ties differently
    assert np.max(np.abs(counts - ruler)) <= 1


def test_one_count_is_about_14_mK_at_300_K() -> None:
    at = int(radiance_to_counts(band_radiance(np.array([300.0]), BAND).astype(np.float32), SCALES[0])[0])
    step = np.diff(counts_to_brightness_K(np.array([at, at + 1], np.uint16), SCALES[0]))
    assert 0.012 < float(step[0]) < 0.016


def test_saturated_pixels_are_counted() -> None:
    frame = np.full((30, 40), band_radiance(np.array([300.0]), BAND)[0], np.float32)
    frame[:3] = 500.0
    frame[3] = 0.1
    (reading,) = sense([frame], np.array([0.0]), CAMERA, SensorKnobs(lens_mtf_nyquist=1.0), stream(1))
    assert reading.saturated == 4 * 40
    assert reading.counts.dtype == np.uint16


def test_same_generator_same_bytes_and_no_look_ahead() -> None:
    np.testing.assert_array_equal(_counts(5), _counts(5))
    np.testing.assert_array_equal(_counts(5)[:3], _counts(3))
    assert not np.array_equal(_counts(5, seed=1), _counts(5, seed=2))


def test_fixed_pattern_stays_within_a_clip_and_differs_between_clips() -> None:
    still = [_clip(1)[0]] * 3
    knobs = SensorKnobs(noise=False)
    first, again = (
        [r.counts for r in sense(still, np.arange(3.0), CAMERA, knobs, stream(seed))] for seed in (1, 2)
    )
    np.testing.assert_array_equal(first[0], first[1])
    np.testing.assert_array_equal(first[0], first[2])
    assert not np.array_equal(first[0], again[0])


def test_switching_a_noise_part_off_leaves_the_others_as_they_were() -> None:
    a = Microbolometer(CAMERA, SensorKnobs(), stream(4)).unit
    b = Microbolometer(CAMERA, SensorKnobs(fixed_columns=0.0), stream(4)).unit
    np.testing.assert_array_equal(a.pixel, b.pixel)
    np.testing.assert_array_equal(a.row, b.row)
    assert not b.column.any()
    clean = _counts(3, noise=False, pattern=False)
    np.testing.assert_array_equal(clean, _counts(3, netd_mk=0.0))


def test_sensing_does_not_change_its_input() -> None:
    clip = _clip(2)
    kept = [frame.copy() for frame in clip]
    sense(clip, np.array([0.0, 0.01]), CAMERA, SensorKnobs(), stream(1))
    for frame, copy in zip(clip, kept, strict=True):
        np.testing.assert_array_equal(frame, copy)


def test_bad_frames_are_refused() -> None:
    good = _clip(1)[0]
    detector = Microbolometer(CAMERA, SensorKnobs(), stream(1))
    with pytest.raises(ValueError, match="not finite"):
        detector.read(np.where(np.arange(40) == 3, np.float32(np.nan), good), 0.0)
    with pytest.raises(ValueError, match="the camera has"):
        detector.read(good[:10], 0.0)
    detector.read(good, 1.0)
    with pytest.raises(ValueError, match="does not follow"):
        detector.read(good, 1.0)


@pytest.mark.parametrize(
    "bad",
    [
        {"netd_mk": -1.0}, {"netd_mk": float("nan")}, {"netd_mk": True}, {"time_constant_ms": 0.0},
        {"scale_K": (423.0, 233.0)}, {"scale_K": 300.0}, {"linear_in": "volts"}, {"netd": 50.0},
    ],
)  # fmt: skip
def test_bad_knobs_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        SensorKnobs(**bad)


def test_percentile_agc_uses_the_whole_range() -> None:
    grey = percentile_agc(_clip(1)[0])
    assert grey.dtype == np.uint8
    assert grey.min() == 0
    assert grey.max() == 255
    flat = percentile_agc(np.full((4, 4), 3.0, np.float32))
    assert len(np.unique(flat)) == 1


def test_plateau_agc_keeps_order_and_gives_detail_to_the_busy_range() -> None:
    rng = stream(8)
    counts = np.full((64, 64), 1000, np.uint16)  # a flat sky over half the image
    counts[32:] = rng.integers(5000, 5200, (32, 64))
    counts[63, :4] = 9000  # a few hot pixels
    grey = plateau_agc(counts, linear_share=0.0, max_gain=4.0)
    order = np.argsort(counts.ravel(), kind="stable")
    assert np.all(np.diff(grey.ravel()[order].astype(int)) >= 0)
    ground = grey[32:63].astype(int)
    linear = percentile_agc(counts, 0.0, 100.0)[32:63].astype(int)
    assert np.ptp(ground) > 20 * np.ptp(linear)


def test_plateau_agc_does_not_amplify_a_flat_scene() -> None:
    counts = stream(9).integers(6000, 6004, (32, 32)).astype(np.uint16)
    assert np.ptp(plateau_agc(counts, max_gain=1.0).astype(int)) <= 4
    assert len(np.unique(plateau_agc(np.full((8, 8), 5000, np.uint16)))) == 1


def test_cameras_of_a_flock_are_those_of_their_drones_alone() -> None:
    """Each with a pattern of its own; who comes down earlier leaves the others as they are."""
    ids, knobs = [7, 3, 12], SensorKnobs()
    scene = np.stack(_clip(4))
    flock = Flock(CAMERA, knobs, {k: stream(1, "unit", k) for k in ids})
    alone = {k: Microbolometer(CAMERA, knobs, stream(1, "unit", k)) for k in ids}
    for n, flying in enumerate(([7, 3, 12], [12, 7], [7], [12, 3])):
        frames = np.stack([scene[(n + k) % 4] for k in flying])
        counts = flock.read(np.array(flying), frames, n / 9.0)
        for row, k in zip(counts, flying, strict=True):
            np.testing.assert_array_equal(row, alone[k].read(scene[(n + k) % 4], n / 9.0).counts)
    same = Flock(CAMERA, knobs, {k: stream(1, "unit", k) for k in ids})
    first, second = same.read(np.array(ids[:2]), np.stack([scene[0], scene[0]]), 0.0).astype(int)
    assert (first != second).mean() > 0.5
    with pytest.raises(ValueError, match="does not follow"):
        same.read(np.array(ids[:1]), scene[:1], 0.0)
