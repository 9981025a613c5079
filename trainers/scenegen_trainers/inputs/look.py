"""What a network may know of one moment, and the array it is given: gain, flow, simplified depth, embedding, in order.

Augmentation stands between `look` and `compose`: a mirrored thermal image gets a fresh grid, which is never mirrored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Real, UInt8

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.embed import embed
from scenegen_trainers.inputs.flow import pair_flow
from scenegen_trainers.inputs.gain import grey_pair
from scenegen_trainers.inputs.knobs import InputKnobs
from scenegen_trainers.inputs.simplify import simplified_depth


@dataclass(frozen=True, eq=False)
class Look:
    """One moment.

    Attributes
    ----------
    now, before : uint8 (rows, columns)
        Grey frames.
    flow : float32 (rows, columns, 2) or None
        What is embedded [px]; None for the conventional method.
    """

    now: UInt8[np.ndarray, "rows columns"]
    before: UInt8[np.ndarray, "rows columns"]
    flow: Float32[np.ndarray, "rows columns 2"] | None

    def mirrored(self) -> Look:
        """Left and right exchanged: what the camera would have seen in a mirrored world."""
        flow = None if self.flow is None else self.flow[:, ::-1] * np.array([-1.0, 1.0], np.float32)
        return Look(self.now[:, ::-1], self.before[:, ::-1], flow)


def look(
    counts: Real[np.ndarray, "rows columns"],
    previous: Real[np.ndarray, "height width"],
    knobs: InputKnobs,
    true_flow: Float32[np.ndarray, "rows columns 2"] | None = None,
) -> Look:
    """Gain and flow.

    Parameters
    ----------
    counts, previous : (rows, columns)
        Thermal frames in counts.
    knobs : InputKnobs
    true_flow : float32 (rows, columns, 2), optional
        Of the current frame towards the previous one [px]; needed by `flow` truth.

    Raises
    ------
    InputError
        If the frames differ in size, hold values that are not finite, or true flow is asked for and missing.
    """
    if counts.shape != previous.shape:
        raise InputError(
            f"a frame of {counts.shape} pixels follows one of {previous.shape}; sizes must agree"
        )
    now, before = grey_pair(counts, previous, knobs)
    if knobs.flow == "none":
        return Look(now, before, None)
    if knobs.flow == "truth":
        if true_flow is None:
            raise InputError(
                "this network was trained on the renderer's true flow, which is known in datasets only; "
                "to fly, train one with --inputs.flow farneback or dis"
            )
        return Look(now, before, true_flow)
    return Look(now, before, pair_flow(now, before, knobs))


def compose(seen: Look, knobs: InputKnobs) -> UInt8[np.ndarray, "channels rows columns"]:
    """The network's input as grey levels: the thermal image, embedded or not, the previous frame where two are asked
    for, and the simplified depth image where it has a channel of its own."""
    frames = [seen.now, seen.before][: knobs.frames]
    if seen.flow is None:
        return np.stack(frames)
    simplified = simplified_depth(seen.flow, knobs)
    if knobs.flow_shown == "channel":
        return np.stack([*frames, simplified])
    return np.stack([embed(seen.now, simplified, knobs.interval), *frames[1:]])


def centred(grey: UInt8[np.ndarray, "..."]) -> Float32[np.ndarray, "..."]:
    """Grey levels as numbers in -1..1, what networks are fed."""
    return grey.astype(np.float32) * np.float32(2.0 / 255.0) - np.float32(1.0)
