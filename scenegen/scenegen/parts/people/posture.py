"""Where the joints of a body are: standing, walking, sitting, running, at any phase of the step.

Angles and segment lengths: Winter 2009, Biomechanics and Motor Control of Human Movement, figure 4.1 (segments as
shares of the height) and the shape of the joint angles of natural gait in appendix A.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

POSTURES = ("standing", "walking", "sitting", "running")

HEIGHT_M = 1.75
"""Height of the adult template."""
SEAT_M = 0.45
"""Height of the seat a sitting body expects."""

THIGH_M, SHIN_M, ANKLE_M = 0.43, 0.43, 0.075
UPPER_ARM_M, FOREARM_M, HAND_M = 0.29, 0.25, 0.17
_HIP_HALF_M, _SHOULDER_HALF_M = 0.092, 0.195
_TRUNK_M = 0.5


@dataclass(frozen=True, eq=False)
class Pose:
    """Joints of a body that stands or sits at the origin and faces +x; pairs are right, left.

    Attributes
    ----------
    pelvis, neck : float64 (3,)
        Middle between the hips and foot of the neck [m].
    hip, knee, ankle, toe : float64 (2, 3)
    shoulder, elbow, wrist, finger : float64 (2, 3)
    lean_rad : float
        Of the trunk, forwards.
    """

    pelvis: Float64[np.ndarray, "3"]
    neck: Float64[np.ndarray, "3"]
    hip: Float64[np.ndarray, "2 3"]
    knee: Float64[np.ndarray, "2 3"]
    ankle: Float64[np.ndarray, "2 3"]
    toe: Float64[np.ndarray, "2 3"]
    shoulder: Float64[np.ndarray, "2 3"]
    elbow: Float64[np.ndarray, "2 3"]
    wrist: Float64[np.ndarray, "2 3"]
    finger: Float64[np.ndarray, "2 3"]
    lean_rad: float


@dataclass(frozen=True, eq=False)
class _Angles:
    """Flexion [degrees], right and left; thigh and upper arm forwards from hanging, knee and elbow from straight."""

    thigh: np.ndarray
    knee: np.ndarray
    arm: np.ndarray
    elbow: np.ndarray
    lean: float
    spread: float = 7.0


def pose(posture: str, phase: float = 0.0) -> Pose:
    """Joints in a posture.

    Parameters
    ----------
    posture : str
        One of `POSTURES`.
    phase : float
        Share of a full step cycle, 0..1, for walking and running; elsewhere it shifts the weight a little.
    """
    return _skeleton(_angles(posture, phase), posture == "sitting")


def _angles(posture: str, phase: float) -> _Angles:
    turn = 2 * np.pi * (phase + np.array([0.0, 0.5]))
    swing = np.sin(turn)
    if posture == "standing":
        shift = 2.0 * np.sin(turn)
        return _Angles(shift, 3.0 + np.abs(shift), 4.0 + 3.0 * shift, np.array([14.0, 10.0]), 1.0, 8.0)
    if posture == "walking":
        lift = np.maximum(np.cos(turn + 0.5), 0.0) ** 1.5
        return _Angles(4.0 + 22.0 * swing, 5.0 + 52.0 * lift, -22.0 * swing, 22.0 - 10.0 * swing, 4.0)
    if posture == "running":
        lift = (0.5 + 0.5 * np.cos(turn - 0.6)) ** 1.3
        return _Angles(14.0 + 36.0 * swing, 16.0 + 92.0 * lift, -34.0 * swing, np.full(2, 92.0), 11.0, 12.0)
    if posture == "sitting":
        hands = 17.0 + 4.0 * np.sin(turn)
        return _Angles(np.array([84.0, 83.0]), np.array([80.0, 86.0]), hands, np.array([48.0, 45.0]), -6.0)
    raise ValueError(f"no posture '{posture}'")


def _down(angle_deg: np.ndarray | float) -> np.ndarray:
    """Unit vectors that hang down, turned forwards."""
    a = np.deg2rad(np.atleast_1d(angle_deg))
    return np.stack([np.sin(a), np.zeros_like(a), -np.cos(a)], axis=1)


def _skeleton(angles: _Angles, seated: bool) -> Pose:
    side = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    lean = np.deg2rad(angles.lean)
    trunk = np.array([np.sin(lean), 0.0, np.cos(lean)])
    hip = _HIP_HALF_M * side
    knee = hip + THIGH_M * _down(angles.thigh)
    ankle = knee + SHIN_M * _down(angles.thigh - angles.knee)
    toe = ankle + _foot(angles.thigh - angles.knee)
    sole = np.minimum(ankle[:, 2] - ANKLE_M, toe[:, 2] - 0.03)
    lift = SEAT_M + 0.11 if seated else -sole.min()
    shoulder = _SHOULDER_HALF_M * side + (_TRUNK_M - 0.06) * trunk
    out = np.sin(np.deg2rad(angles.spread)) * side
    upper = _down(angles.arm + angles.lean * 0.5) + out
    upper /= np.linalg.norm(upper, axis=1)[:, None]
    elbow = shoulder + UPPER_ARM_M * upper
    lower = _down(angles.arm + angles.elbow)
    wrist = elbow + FOREARM_M * lower
    up = np.array([0.0, 0.0, lift])
    return Pose(
        pelvis=up,
        neck=up + (_TRUNK_M + 0.03) * trunk,
        hip=hip + up,
        knee=knee + up,
        ankle=ankle + up,
        toe=toe + up,
        shoulder=shoulder + up,
        elbow=elbow + up,
        wrist=wrist + up,
        finger=wrist + HAND_M * lower + up,
        lean_rad=float(lean),
    )


def _foot(shin_deg: np.ndarray) -> np.ndarray:
    """From ankle to toe: level under an upright shin, pointing down behind the body."""
    a = np.deg2rad(np.clip(0.75 * shin_deg, -55.0, 8.0))
    length, drop = 0.19, ANKLE_M - 0.03
    x = length * np.cos(a) + drop * np.sin(a)
    z = length * np.sin(a) - drop * np.cos(a)
    return np.stack([x, np.zeros_like(a), z], axis=1)
