"""The microbolometer against closed forms: NETD, Gaussianity, 3-D noise, lag, independence.

Geometry: a uniform 300 K blackbody (or a step of it) in front of the camera. Expected: temporal noise equal to the
quoted NETD, every component of the 3-D noise model at its configured ratio, an exponential step response.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from scenegen.foundation.rng import stream
from scenegen.radiometry.planck import band_radiance
from scenegen_render.camera import Camera
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.scale import counts_to_brightness_K, counts_to_radiance
from scenegen_render.sensor.sense import Microbolometer, noise_radiance, sense
from scenegen_render.sensor.unit import draw_unit

BAND = (8.0, 14.0)
QUIET = {"fixed_pattern": 0.0, "fixed_columns": 0.0, "fixed_rows": 0.0}
STEADY = {"flickering_columns": 0.0, "flickering_rows": 0.0, "flickering_frame": 0.0}
FINE = {"scale_K": (295.0, 305.0)}  # 0.6 mK a count: quantisation adds less than 1e-5 of the variance


def _uniform(temperature_K: float, rows: int, columns: int) -> np.ndarray:
    value = band_radiance(np.array([temperature_K]), BAND)[0]
    return np.full((rows, columns), value, np.float32)


def _radiance_cube(knobs: SensorKnobs, frames: int, rows: int, columns: int, seed: int = 1) -> np.ndarray:
    """Sensed minus true radiance, in units of the NETD."""
    camera = Camera.from_fov(columns, rows, 45.0)
    detector = Microbolometer(camera, knobs, stream(seed, "sensor"))
    truth = _uniform(300.0, rows, columns)
    cube = np.empty((frames, rows, columns), np.float32)
    for k in range(frames):
        reading = detector.read(truth, k / 30)
        assert reading.saturated == 0
        cube[k] = counts_to_radiance(reading.counts, detector.scale) - truth
    return cube / np.float32(noise_radiance(knobs.netd_mk, BAND))


def test_netd_within_half_a_percent() -> None:
    """1.05e7 samples: the standard error of sigma is 0.022 %."""
    cube = _radiance_cube(SensorKnobs(**QUIET, **STEADY, **FINE), 160, 256, 256)
    assert cube.size > 10**7
    assert float(cube.std(dtype=np.float64)) == pytest.approx(1.0, rel=5e-3)
    assert abs(float(cube.mean(dtype=np.float64))) < 5 / math.sqrt(cube.size)


def test_netd_in_kelvin_at_300_K_on_the_default_scale() -> None:
    """What a user measures: brightness temperature noise, quantisation (14 mK a count) taken off as step^2 / 12."""
    camera = Camera.from_fov(256, 256, 45.0)
    detector = Microbolometer(camera, SensorKnobs(**QUIET, **STEADY), stream(3, "netd"))
    truth = _uniform(300.0, 256, 256)
    T = [counts_to_brightness_K(detector.read(truth, k / 30).counts, detector.scale) for k in range(16)]
    step_K = float(np.diff(counts_to_brightness_K(np.array([6600, 6601], np.uint16), detector.scale))[0])
    noise_mk = 1e3 * math.sqrt(float(np.var(T, dtype=np.float64)) - step_K**2 / 12)
    assert noise_mk == pytest.approx(50.0, rel=5e-3)
    assert float(np.mean(T, dtype=np.float64)) == pytest.approx(300.0, abs=2e-3)


def test_noise_is_gaussian() -> None:
    cube = _radiance_cube(SensorKnobs(**QUIET, **STEADY, **FINE), 16, 256, 256, seed=5)
    step = 0.6e-3 / 50e-3  # one count in units of sigma: spread each count over its width before binning
    x = cube.astype(np.float64).ravel() + stream(5, "dither").uniform(-step / 2, step / 2, cube.size)
    edges = stats.norm.ppf(np.arange(1, 100) / 100)
    observed = np.bincount(np.searchsorted(edges, x), minlength=100)
    assert stats.chisquare(observed).pvalue > 1e-4
    assert abs(stats.skew(x)) < 5 * math.sqrt(6 / x.size)
    assert abs(stats.kurtosis(x)) < 5 * math.sqrt(24 / x.size)


def test_noise_is_independent_in_time_and_space() -> None:
    cube = _radiance_cube(SensorKnobs(**QUIET, **STEADY, **FINE), 24, 128, 128, seed=9).astype(np.float64)
    pairs = {
        "next frame": (cube[:-1], cube[1:]),
        "right": (cube[:, :, :-1], cube[:, :, 1:]),
        "below": (cube[:, :-1], cube[:, 1:]),
    }
    for name, (a, b) in pairs.items():
        r = float(np.corrcoef(a.ravel(), b.ravel())[0, 1])
        assert abs(r) < 5 / math.sqrt(a.size), name


def test_three_dimensional_noise_components() -> None:
    """D'Agostino-Webb decomposition of a long cube gives back every configured ratio within 2 %.

    Each directional average of the independent pixel noise is taken off (its variance over the number averaged), as is
    usual for a finite cube. The small components are configured large enough that 2 % is four standard errors of what
    can be estimated from so many rows, columns and frames.
    """
    frames, rows, columns = 500, 160, 240
    set_to = {
        "fixed_pattern": 0.30, "fixed_columns": 0.0, "fixed_rows": 0.0,
        "flickering_columns": 0.05, "flickering_rows": 0.05, "flickering_frame": 0.0,
    }  # fmt: skip
    knobs = SensorKnobs(**set_to, **FINE)
    cube = _radiance_cube(knobs, frames, rows, columns, seed=11)
    found = _decompose(cube)
    assert found["tvh"] == pytest.approx(1.0, rel=0.02)
    assert found["vh"] == pytest.approx(0.30, rel=0.02)
    assert found["tv"] == pytest.approx(0.05, rel=0.02)
    assert found["th"] == pytest.approx(0.05, rel=0.02)


def test_row_column_and_frame_offsets_match_what_was_drawn() -> None:
    """The fixed rows and columns are too few to estimate a ratio from; their averages must equal the unit's draw."""
    rows, columns, frames = 96, 128, 200
    camera = Camera.from_fov(columns, rows, 45.0)
    knobs = SensorKnobs(**FINE)
    unit = Microbolometer(camera, knobs, stream(13, "sensor")).unit
    cube = _radiance_cube(knobs, frames, rows, columns, seed=13)
    sigma = noise_radiance(knobs.netd_mk, BAND)
    expected = unit.offset() / sigma
    mean = cube.mean(axis=0, dtype=np.float64)
    # mean of 200 frames: pixel noise 0.0707, flickering rows and columns 0.0035 each
    assert float(np.std(mean - expected)) == pytest.approx(math.sqrt((1 + 2 * 0.05**2) / frames), rel=0.03)
    column = mean.mean(axis=0) - mean.mean()
    drawn = expected.mean(axis=0) - expected.mean()
    assert float(np.corrcoef(column, drawn)[0, 1]) > 0.995


def test_rows_columns_and_frames_at_their_ratios() -> None:
    """One camera has too few rows, columns and frames to estimate these from: take many units, many frames."""
    knobs = SensorKnobs(flickering_frame=10.0, scale_K=(280.0, 320.0), pattern=False)
    units = [draw_unit((200, 300), 1.0, knobs, stream(17, "unit", k)) for k in range(100)]
    for part, ratio in (("pixel", 0.30), ("column", 0.15), ("row", 0.08)):
        drawn = np.concatenate([getattr(unit, part).ravel() for unit in units])
        assert float(drawn.std(dtype=np.float64)) == pytest.approx(ratio, rel=0.02), part
    cube = _radiance_cube(knobs, 8000, 4, 4, seed=17)
    frame = float(cube.mean(axis=(1, 2), dtype=np.float64).std())
    assert frame == pytest.approx(10.0, rel=0.02)


def _decompose(cube: np.ndarray) -> dict[str, float]:
    t, v, h = cube.shape
    cube = cube - cube.mean(dtype=np.float64)
    m_vh = cube.mean(axis=0, dtype=np.float64)
    m_tv = cube.mean(axis=2, dtype=np.float64)
    m_th = cube.mean(axis=1, dtype=np.float64)
    m_t, m_v, m_h = m_tv.mean(axis=1), m_vh.mean(axis=1), m_vh.mean(axis=0)
    rest = cube - m_vh - m_tv[:, :, None] - m_th[:, None, :]
    rest += m_t[:, None, None] + m_v[:, None] + m_h
    tvh = float(rest.var(dtype=np.float64)) / ((1 - 1 / t) * (1 - 1 / v) * (1 - 1 / h))
    vh = (m_vh - m_v[:, None] - m_h).var() / ((1 - 1 / v) * (1 - 1 / h)) - tvh / t
    tv = (m_tv - m_t[:, None] - m_v).var() / ((1 - 1 / t) * (1 - 1 / v)) - tvh / h
    th = (m_th - m_t[:, None] - m_h).var() / ((1 - 1 / t) * (1 - 1 / h)) - tvh / v
    return {"tvh": math.sqrt(tvh), "vh": math.sqrt(vh), "tv": math.sqrt(tv), "th": math.sqrt(th)}


@pytest.mark.parametrize("rate_hz", [9.0, 30.0, 60.0, 200.0])
def test_step_response_is_exponential(rate_hz: float) -> None:
    """A step from 290 K to 310 K: the remaining distance shrinks by exp(-dt/tau) a frame."""
    camera = Camera.from_fov(8, 6, 45.0)
    knobs = SensorKnobs(noise=False, pattern=False, scale_K=(285.0, 315.0), time_constant_ms=10.0)
    detector = Microbolometer(camera, knobs, stream(0))
    before, after = _uniform(290.0, 6, 8), _uniform(310.0, 6, 8)
    count_radiance = (detector.scale.ends[1] - detector.scale.ends[0]) / 16_383
    detector.read(before, 0.0)
    for k in range(1, 12):
        seen = counts_to_radiance(detector.read(after, k / rate_hz).counts, detector.scale)
        expected = after + (before - after) * math.exp(-k / rate_hz / 0.010)
        np.testing.assert_allclose(seen, expected, atol=0.51 * count_radiance + 1e-5)


def test_lag_follows_uneven_time_stamps_and_can_be_switched_off() -> None:
    camera = Camera.from_fov(4, 4, 45.0)
    base = {"noise": False, "pattern": False, "scale_K": (285.0, 315.0)}
    frames = [_uniform(T, 4, 4) for T in (290.0, 310.0, 310.0)]
    once = sense(frames, np.array([0.0, 0.004, 0.009]), camera, SensorKnobs(**base), stream(0))
    twice = sense(frames[:2], np.array([0.0, 0.009]), camera, SensorKnobs(**base), stream(0))
    np.testing.assert_allclose(once[2].counts, twice[1].counts, atol=1)
    sharp = sense(frames[:2], np.array([0.0, 0.001]), camera, SensorKnobs(**base, lag=False), stream(0))
    steady = sense(frames[1:2], np.array([0.0]), camera, SensorKnobs(**base), stream(0))
    np.testing.assert_array_equal(sharp[1].counts, steady[0].counts)
