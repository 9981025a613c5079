"""A body as a template: head, trunk, arms and legs lofted over the joints of a pose.

All poses have the same triangles in the same order, so that a walker is one topology with moving vertices.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template
from scenegen.parts.lofts import fan_faces, loft_faces, oval_rings
from scenegen.parts.people.posture import Pose, pose
from scenegen.parts.skin import Skin

SKIN, HAIR, TOP, SLEEVE, BOTTOM, SHIN, SHOE = range(7)
"""Surface slots: face, neck and hands; hair or hat; trunk and upper arms; forearms; hips and thighs; shins; shoes."""

_Y = np.array([0.0, 1.0, 0.0])
_LEAST_HEIGHT_M = 0.2
"""Of sites, above the ground: lumps start looking a standoff away."""


@lru_cache(maxsize=256)
def body(posture: str, phase: float = 0.0, child: bool = False) -> Template:
    """A body of 1.75 m, feet on z = 0, facing +x; scale it to size.

    Parameters
    ----------
    posture : str
        One of `scenegen.parts.people.posture.POSTURES`. A sitting body has its origin on the ground under the seat.
    phase : float
        Share of the step cycle, 0..1.
    child : bool
        Larger head, for bodies of less than 1.45 m.
    """
    joints = pose(posture, phase)
    skin = Skin(Semantic.PERSON, smooth=True)
    _sites(skin, joints)
    _trunk(skin, joints)
    _head(skin, joints, 1.3 if child else 1.0)
    for k in range(2):
        _leg(skin, joints, k)
        _arm(skin, joints, k)
    return skin.finish()


def _sites(skin: Skin, joints: Pose) -> None:
    """Where the heat of the body lives: in front and behind, and left and right of the arms."""
    front = np.array([1.0, 0.0, 0.15])
    chest = 0.4 * joints.pelvis + 0.6 * joints.neck
    skin.site(SKIN, joints.neck + np.array([0.11, 0.0, 0.15]), front, LUMP_STANDOFF_M)
    skin.site(HAIR, joints.neck + np.array([-0.08, 0.0, 0.24]), (-0.45, 0.0, 0.9), LUMP_STANDOFF_M)
    for sign in (1.0, -1.0):
        skin.site(TOP, chest, sign * front * [1.0, 1.0, sign], LUMP_STANDOFF_M)
        arm = 0.5 * (joints.elbow + joints.wrist)[(1 + int(sign)) // 2]
        skin.site(SLEEVE, arm, sign * _Y, LUMP_STANDOFF_M)
    for slot, upper, lower in ((BOTTOM, joints.hip, joints.knee), (SHIN, joints.knee, joints.ankle)):
        axis = (lower - upper).mean(axis=0)
        ahead = np.array([-axis[2], 0.0, axis[0]]) / np.hypot(axis[0], axis[2])
        middle = 0.5 * (upper + lower).mean(axis=0)
        middle[2] = max(middle[2], _LEAST_HEIGHT_M)
        for sign in (1.0, -1.0):
            skin.site(slot, middle + 0.1 * sign * ahead, sign * ahead, LUMP_STANDOFF_M)
    toe = joints.toe[np.argmin(joints.toe[:, 2])]
    skin.site(SHOE, np.maximum(toe, [-9.0, -9.0, _LEAST_HEIGHT_M]), (0.6, 0.0, 0.8), LUMP_STANDOFF_M, 0.0)


def _limb(
    skin: Skin, centre: np.ndarray, radii: np.ndarray, points: int, slots: np.ndarray, lids: str = ""
) -> None:
    """An oval tube; `slots` has one entry per band; lids "s" and "e" close start and end."""
    rings = oval_rings(centre, _Y, radii, points)
    faces = loft_faces(len(rings), points)
    slot = np.repeat(slots, 2 * points)
    if "s" in lids:
        faces = np.concatenate([faces, fan_faces(points, flip=True)])
        slot = np.append(slot, np.full(points - 2, slots[0]))
    if "e" in lids:
        faces = np.concatenate([faces, fan_faces(points, (len(rings) - 1) * points)])
        slot = np.append(slot, np.full(points - 2, slots[-1]))
    skin.add(rings.reshape(-1, 3), faces, slot)


def _along(start: np.ndarray, end: np.ndarray, *share: float) -> np.ndarray:
    return np.asarray(start + np.array(share)[:, None] * (end - start))


def _trunk(skin: Skin, joints: Pose) -> None:
    centre = _along(joints.pelvis, joints.neck, -0.13, 0.0, 0.28, 0.62, 0.84, 0.93, 1.0)
    radii = [
        [0.10, 0.08],
        [0.165, 0.12],
        [0.138, 0.1],
        [0.165, 0.122],
        [0.19, 0.1],
        [0.15, 0.08],
        [0.07, 0.06],
    ]
    _limb(skin, centre, np.array(radii), 8, np.array([BOTTOM, BOTTOM, TOP, TOP, TOP, TOP]), "se")


_HEAD_POINTS = 10
# Slots of the head's bands from the chin to the crown; columns 5 to 9 look forwards.
_HEAD = np.full((5, _HEAD_POINTS), HAIR)
_HEAD[0] = _HEAD[1, 5:] = _HEAD[2, 6:9] = SKIN


def _head(skin: Skin, joints: Pose, size: float) -> None:
    tilt = np.array([0.4 * np.sin(joints.lean_rad), 0.0, 1.0])
    neck = _along(joints.neck - 0.03 * tilt, joints.neck + 0.07 * tilt, 0.0, 1.0)
    _limb(skin, neck, np.array([[0.062, 0.062], [0.055, 0.06]]), 6, np.array([SKIN]))
    level = size * np.array([0.0, 0.035, 0.095, 0.15, 0.21, 0.235])
    forward = size * np.array([0.03, 0.025, 0.015, 0.01, 0.002, 0.0])
    centre = joints.neck + 0.035 * tilt + level[:, None] * tilt + forward[:, None] * [1.0, 0.0, 0.0]
    radii = [[0.04, 0.055], [0.062, 0.08], [0.075, 0.096], [0.078, 0.1], [0.055, 0.075], [0.02, 0.03]]
    rings = oval_rings(centre, _Y, size * np.array(radii), _HEAD_POINTS)
    lids = [fan_faces(_HEAD_POINTS, 5 * _HEAD_POINTS), fan_faces(_HEAD_POINTS, flip=True)]
    faces = np.concatenate([loft_faces(6, _HEAD_POINTS), *lids])
    slot = np.concatenate([np.repeat(_HEAD.ravel(), 2), np.repeat([HAIR, SKIN], _HEAD_POINTS - 2)])
    skin.add(rings.reshape(-1, 3), faces, slot)


def _leg(skin: Skin, joints: Pose, k: int) -> None:
    hip, knee, ankle = joints.hip[k], joints.knee[k], joints.ankle[k]
    centre = np.concatenate([_along(hip, knee, -0.02, 0.45), _along(knee, ankle, 0.0, 0.32, 1.02)])
    radii = np.array([[0.086, 0.1], [0.078, 0.087], [0.057, 0.062], [0.055, 0.064], [0.042, 0.048]])
    _limb(skin, centre, radii, 6, np.array([BOTTOM, BOTTOM, SHIN, SHIN]), "e")
    _shoe(skin, ankle, joints.toe[k])


# Sections of a shoe from heel to tip: place ahead of the ankle, half-width, sole and instep below the ankle [m].
_SHOE = (
    (-0.08, 0.034, 0.075, 0.0),
    (0.0, 0.042, 0.075, -0.03),
    (0.06, 0.045, 0.075, 0.0),
    (0.13, 0.05, 0.075, 0.035),
    (0.2, 0.03, 0.07, 0.05),
)


def _shoe(skin: Skin, ankle: np.ndarray, toe: np.ndarray) -> None:
    """A wedge from heel to toe under the ankle."""
    sole = np.cross(toe - ankle, -_Y)
    sole /= np.linalg.norm(sole)
    ahead = np.cross(-_Y, sole)
    turn = np.arctan2(0.045, 0.19)  # the toe lies lower than the ankle in a level shoe
    ahead, sole = np.cos(turn) * ahead - np.sin(turn) * sole, np.cos(turn) * sole + np.sin(turn) * ahead
    rows = []
    for x, half, low, high in _SHOE:
        ring = ((half, low), (half * 0.75, high), (-half * 0.75, high), (-half, low))
        rows.append([ankle + x * ahead + y * _Y + z * sole for y, z in ring])
    vertices, last = np.array(rows).reshape(-1, 3), 4 * (len(_SHOE) - 1)
    faces = np.concatenate([loft_faces(len(_SHOE), 4), fan_faces(4, 0, True), fan_faces(4, last)])
    skin.add(vertices, faces, SHOE)


def _arm(skin: Skin, joints: Pose, k: int) -> None:
    shoulder, elbow, wrist, finger = joints.shoulder[k], joints.elbow[k], joints.wrist[k], joints.finger[k]
    inner = shoulder + np.array([0.0, -0.075 if shoulder[1] > 0 else 0.075, 0.03])
    centre = np.concatenate(
        [inner[None], _along(shoulder, elbow, -0.02, 0.3, 0.95), _along(wrist, elbow, 0.0)]
    )
    radii = np.array([[0.06, 0.06], [0.06, 0.062], [0.05, 0.056], [0.042, 0.045], [0.03, 0.033]])
    _limb(skin, centre, radii, 6, np.array([TOP, TOP, TOP, SLEEVE]), "s")
    hand = _along(wrist, finger, -0.05, 0.5, 1.0)
    _limb(
        skin, hand, np.array([[0.024, 0.032], [0.022, 0.046], [0.012, 0.025]]), 6, np.array([SKIN, SKIN]), "e"
    )
