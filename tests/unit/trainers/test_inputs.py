"""From counts and metres to what a network reads: each step against numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.embed import embed
from scenegen_trainers.inputs.flow import pair_flow
from scenegen_trainers.inputs.gain import grey_pair
from scenegen_trainers.inputs.knobs import InputKnobs, TargetKnobs
from scenegen_trainers.inputs.look import Look, centred, compose, look
from scenegen_trainers.inputs.simplify import simplified_depth
from scenegen_trainers.inputs.target import decode, encode


def textured(rows: int, columns: int, seed: int = 0) -> np.ndarray:
    """Smooth random relief in counts, that flow can hold on to."""
    spectrum = np.fft.fft2(np.random.default_rng(seed).normal(size=(rows, columns)))
    fy, fx = np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)
    relief = np.real(np.fft.ifft2(spectrum * np.exp(-((fx**2 + fy**2) / 0.02))))
    return (8000.0 + 2000.0 * relief / relief.std()).astype(np.uint16)


def test_eq_1_pixel_by_pixel() -> None:
    thermal = np.full((11, 7), 9, np.uint8)
    simplified = np.arange(1, 78, dtype=np.uint8).reshape(11, 7)
    simplified[5, 0] = 0
    embedded = embed(thermal, simplified, 5)
    for n in range(11):
        for m in range(7):
            taken = n % 5 == 0 and m % 5 == 0 and simplified[n, m] != 0
            assert embedded[n, m] == (simplified[n, m] if taken else 9)
    assert (thermal == 9).all()


def test_eq_1_takes_one_pixel_in_25_of_a_square_image() -> None:
    embedded = embed(np.zeros((256, 256), np.uint8), np.ones((256, 256), np.uint8), 5)
    assert embedded.sum() == 52 * 52


def test_percentiles_of_both_frames_become_black_and_white() -> None:
    now = np.arange(100, dtype=np.uint16).reshape(10, 10)
    before = now + 100
    grey, grey_before = grey_pair(now, before, InputKnobs(gain_percent=(0.0, 1.0)))
    assert grey[0, 0] == 0 and grey_before[-1, -1] == 255
    assert grey[5, 0] == round(50 * 255 / 199)


def test_a_shared_gain_keeps_brightness_a_gain_of_its_own_does_not() -> None:
    now = textured(40, 40)
    before = now.copy()
    before[:20] //= 2  # a cold cloud comes in
    rest = slice(20, None)
    together = grey_pair(now, before, InputKnobs())
    assert (together[0][rest] == together[1][rest]).all()
    alone = grey_pair(now, before, InputKnobs(gain_shared=False))
    assert np.abs(alone[0][rest].astype(int) - alone[1][rest]).mean() > 10


@pytest.mark.parametrize("gain", ["percentile", "minmax", "clahe"])
def test_integers_and_floats_give_the_same_grey(gain: str) -> None:
    now, before = textured(33, 47), textured(33, 47, 1)
    knobs = InputKnobs.model_validate({"gain": gain})
    whole = grey_pair(now, before, knobs)
    real = grey_pair(now.astype(np.float32), before.astype(np.float32), knobs)
    assert all((a == b).all() for a, b in zip(whole, real, strict=True))
    assert whole[0].max() > 200 > 60 > whole[0].min()


def test_a_frame_of_one_value_has_a_grey() -> None:
    flat = np.full((30, 30), 5000, np.uint16)
    assert len(np.unique(grey_pair(flat, flat, InputKnobs())[0])) == 1


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_counts_that_are_no_numbers_are_refused(bad: float) -> None:
    frame = np.full((8, 8), 100.0)
    frame[3, 3] = bad
    with pytest.raises(InputError, match="not finite"):
        look(frame, frame, InputKnobs())


def test_frames_of_two_sizes_are_refused() -> None:
    with pytest.raises(InputError, match="sizes must agree"):
        look(textured(8, 8), textured(8, 9), InputKnobs())


@pytest.mark.parametrize("method", ["farneback", "dis"])
def test_flow_of_a_shifted_image(method: str) -> None:
    """What is at x now was at x - 3 before: flow towards the previous frame is -3, the other way +3."""
    before = (textured(96, 128) // 64).astype(np.uint8)
    now = np.roll(before, 3, axis=1)
    inner = (slice(20, -20), slice(20, -20))
    backward = pair_flow(now, before, InputKnobs.model_validate({"flow": method}))
    assert np.median(backward[inner][..., 0]) == pytest.approx(-3.0, abs=0.1)
    assert np.median(backward[inner][..., 1]) == pytest.approx(0.0, abs=0.1)
    forward = pair_flow(now, before, InputKnobs.model_validate({"flow": method, "flow_grid": "previous"}))
    assert np.median(forward[inner][..., 0]) == pytest.approx(3.0, abs=0.1)


def test_dis_says_that_frames_are_too_small() -> None:
    small = textured(12, 16)
    with pytest.raises(InputError, match="24 px"):
        look(small, small, InputKnobs(flow="dis"))


def flow_of_lengths(*lengths: float) -> np.ndarray:
    """One row; directions turn from pixel to pixel."""
    angles = np.arange(len(lengths)) * 2.1
    return np.stack([lengths * np.cos(angles), lengths * np.sin(angles)], -1)[None].astype(np.float32)


def test_simplified_depth_from_least_to_most() -> None:
    value = simplified_depth(flow_of_lengths(1.0, 2.0, 3.0), InputKnobs())
    assert value[0, 0] == 0 and value[0, 2] == 255 and value[0, 1] in (126, 127)


def test_simplified_depth_on_a_fixed_scale_knows_speed() -> None:
    flow = flow_of_lengths(0.2, 2.01, 3.01, 90.0)
    assert simplified_depth(flow, InputKnobs(flow_scale="x4")).tolist() == [[0, 8, 12, 255]]
    full = InputKnobs(flow_scale="full", flow_full_px=6.0)
    assert simplified_depth(flow, full).tolist() == [[8, 85, 127, 255]]


def test_no_motion_and_no_flow_embed_nothing() -> None:
    flow = np.full((4, 4, 2), np.nan, np.float32)
    assert not simplified_depth(flow, InputKnobs()).any()
    assert not simplified_depth(np.full((4, 4, 2), 2.0, np.float32), InputKnobs()).any()


def test_grey_value_mixes_in_direction() -> None:
    """Pure red is 0.299 bright, pure green 0.587, pure blue 0.114 (ITU-R BT.601); V is 1 for all."""
    angles = np.deg2rad([0.0, 120.0, 240.0])
    flow = np.stack([100 * np.cos(angles), 100 * np.sin(angles)], -1)[None].astype(np.float32)
    luma = simplified_depth(flow, InputKnobs(simplified="luma", flow_scale="x4"))[0] / 255.0
    assert luma == pytest.approx([0.299, 0.587, 0.114], abs=0.01)
    assert (simplified_depth(flow, InputKnobs(flow_scale="x4")) == 255).all()


def test_a_mirrored_sample_gets_a_fresh_grid() -> None:
    rows, columns = 12, 13
    flow = np.zeros((rows, columns, 2), np.float32)
    flow[..., 0] = np.arange(columns)
    seen = Look(np.zeros((rows, columns), np.uint8), np.zeros((rows, columns), np.uint8), flow)
    mirrored = seen.mirrored()
    assert mirrored.flow is not None and mirrored.flow[0, 0, 0] == -(columns - 1)
    image = compose(mirrored, InputKnobs())[0]
    there = np.argwhere(image)
    assert len(there) and (there % 5 == 0).all()
    assert image[0, 0] == 255  # the fastest pixel stood at the right


def test_channels_and_range() -> None:
    now, before = textured(30, 30), textured(30, 30, 1)
    one = compose(look(now, before, InputKnobs(flow="none")), InputKnobs(flow="none"))
    two = compose(look(now, before, InputKnobs(frames=2)), InputKnobs(frames=2))
    assert one.shape == (1, 30, 30) and two.shape == (2, 30, 30)
    assert (two[1] == grey_pair(now, before, InputKnobs())[1]).all()
    assert centred(np.array([0, 255], np.uint8)).tolist() == [-1.0, 1.0]


@pytest.mark.parametrize("frames", [1, 2])
def test_flow_can_have_a_channel_of_its_own(frames: int) -> None:
    knobs = InputKnobs.model_validate({"frames": frames, "flow": "truth", "flow_shown": "channel"})
    now, before = np.full((6, 8), 9000, np.uint16), np.full((6, 8), 3000, np.uint16)
    now[0, 0] = 0
    flow = np.zeros((6, 8, 2), np.float32)
    flow[..., 0] = np.arange(8)
    seen = look(now, before, knobs, flow)
    image = compose(seen, knobs)
    assert image.shape == (knobs.channels, 6, 8) == (frames + 1, 6, 8)
    assert (image[0] == seen.now).all() and (image[-1] == simplified_depth(flow, knobs)).all()
    assert np.abs(image[-1] - np.arange(8) * 255.0 / 7.0).max() <= 1.0  # fractions are cut off
    assert (compose(seen.mirrored(), knobs) == image[:, :, ::-1]).all()


def test_true_flow_has_to_be_there() -> None:
    now = textured(30, 30)
    with pytest.raises(InputError, match="known in datasets only"):
        look(now, now, InputKnobs(flow="truth"))
    flow = np.zeros((30, 30, 2), np.float32)
    assert look(now, now, InputKnobs(flow="truth"), flow).flow is flow
    with pytest.raises(ValueError, match="flow_grid"):
        InputKnobs(flow="truth", flow_grid="previous")


@given(st.floats(0.5, 99.9), st.sampled_from(["linear", "log"]))
def test_depth_comes_back_from_its_picture(depth_m: float, scale: str) -> None:
    knobs = TargetKnobs.model_validate({"scale": scale})
    code, judged = encode(np.full((2, 2), depth_m, np.float32), knobs)
    assert judged.all() and -1.0 <= code[0, 0] <= 1.0
    assert float(decode(code, knobs)[0, 0]) == pytest.approx(depth_m, rel=1e-4, abs=1e-4)


def test_sky_is_painted_as_the_cap_or_left_out() -> None:
    depth = np.array([[50.0, 100.0, 400.0, np.inf]], np.float32)
    code, judged = encode(depth, TargetKnobs())
    assert code.tolist() == [[0.0, 1.0, 1.0, 1.0]] and judged.all()
    assert encode(depth, TargetKnobs(sky="ignore"))[1].tolist() == [[True, False, False, False]]


@pytest.mark.parametrize("bad", [np.nan, 0.0, -1.0])
def test_depth_that_is_none_is_refused(bad: float) -> None:
    with pytest.raises(InputError, match="scenegen verify"):
        encode(np.array([[1.0, bad]], np.float32), TargetKnobs())
