"""How the camera sits on the airframe: tipped by the mount, shaken by the rotors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

_LINES = 4
_BAND_HZ = (40.0, 180.0)
"""From the slowest turning of small rotors to the blade passing of fast ones."""


def body_from_camera(pitch_deg: float) -> Float64[np.ndarray, "3 3"]:
    """Camera axes (right, down, ahead) in the airframe's (nose, left, up); negative pitch looks down."""
    up, ahead = math.sin(math.radians(pitch_deg)), math.cos(math.radians(pitch_deg))
    return np.array([[0.0, up, ahead], [-1.0, 0.0, 0.0], [0.0, -ahead, up]])


@dataclass(frozen=True, eq=False)
class Vibration:
    """Small turns of the camera about its own axes: a few seeded lines of rotor noise per axis.

    Attributes
    ----------
    amplitude_rad, frequency_hz, phase_rad : float64 (3, lines)
        One row per camera axis.
    """

    amplitude_rad: Float64[np.ndarray, "3 lines"]
    frequency_hz: Float64[np.ndarray, "3 lines"]
    phase_rad: Float64[np.ndarray, "3 lines"]

    @staticmethod
    def draw(rms_mrad: float, rng: np.random.Generator) -> Vibration:
        """Lines that together have this root mean square about each axis."""
        weights = 0.2 + rng.random((3, _LINES))
        weights /= np.sqrt((weights**2).sum(axis=1, keepdims=True) / 2.0)
        frequencies = _BAND_HZ[0] * (_BAND_HZ[1] / _BAND_HZ[0]) ** rng.random((3, _LINES))
        return Vibration(1e-3 * rms_mrad * weights, frequencies, rng.uniform(0.0, 2 * np.pi, (3, _LINES)))

    def at(self, t: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "times 3 3"]:
        """Rotations ``still camera from shaken camera`` at instants."""
        phase = 2 * np.pi * t[:, None, None] * self.frequency_hz + self.phase_rad
        return rotations((self.amplitude_rad * np.sin(phase)).sum(axis=2))


def rotations(vector: Float64[np.ndarray, "many 3"]) -> Float64[np.ndarray, "many 3 3"]:
    """Rotation matrices of rotation vectors [rad] (Rodrigues)."""
    angle = np.linalg.norm(vector, axis=1)[:, None, None]
    cross = np.zeros((len(vector), 3, 3))
    x, y, z = vector.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= cross.transpose(0, 2, 1)
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
    return np.asarray(np.eye(3) + first * cross + second * (cross @ cross))
