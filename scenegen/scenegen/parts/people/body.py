"""A body as a template: head, trunk, arms and legs lofted over the joints of a pose.

All poses have the same triangles in the same order, so that a walker is one topology with moving vertices.
"""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, face_normals
from scenegen.geometry.template import Template
from scenegen.parts.lofts import fan_faces, loft_faces, oval_rings
from scenegen.parts.people.posture import Pose, pose

SKIN, HAIR, TOP, SLEEVE, BOTTOM, SHIN, SHOE = range(7)
"""Surface slots: face, neck and hands; hair or hat; trunk and upper arms; forearms; hips and thighs; shins; shoes."""

_Y = np.array([0.0, 1.0, 0.0])


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
    sculptor = _Sculptor(joints)
    _trunk(sculptor, joints)
    _head(sculptor, joints, 1.3 if child else 1.0)
    for k in range(2):
        _leg(sculptor, joints, k)
        _arm(sculptor, joints, k)
    return sculptor.model.finish()


class _Sculptor:
    """Adds lofts whose faces take the site of their slot that looks their way."""

    def __init__(self, joints: Pose) -> None:
        self.model = Modeller()
        chest = 0.4 * joints.pelvis + 0.6 * joints.neck
        thigh, shin = (
            0.5 * (a + b).mean(axis=0) for a, b in ((joints.hip, joints.knee), (joints.knee, joints.ankle))
        )
        front = np.array([1.0, 0.0, 0.15])
        up = np.array([-0.45, 0.0, 0.9])
        fore = 0.5 * (joints.elbow + joints.wrist)
        low = np.array([0.0, 0.0, 0.22])
        self._sites = {
            SKIN: self._pair(joints.neck + np.array([0.02, 0.0, 0.16]), front, 0.1)[:1],
            HAIR: [self.model.site(joints.neck + np.array([-0.06, 0.0, 0.27]), up, LUMP_STANDOFF_M)],
            TOP: self._pair(chest, front, 0.13),
            SLEEVE: [
                self.model.site(f + 0.05 * s, s, LUMP_STANDOFF_M)
                for f, s in zip(fore, (-_Y, _Y), strict=True)
            ],
            BOTTOM: self._pair(thigh, front, 0.11),
            SHIN: self._pair(np.maximum(shin, low), front, 0.08),
            SHOE: [self.model.site(np.maximum(joints.toe.mean(axis=0), low), front, LUMP_STANDOFF_M)],
        }

    def _pair(self, middle: np.ndarray, front: np.ndarray, reach: float) -> list[int]:
        """A site in front and one behind."""
        behind = front * [-1.0, 1.0, 1.0]
        return [self.model.site(middle + reach * n, n, LUMP_STANDOFF_M) for n in (front, behind)]

    def add(self, vertices: np.ndarray, faces: np.ndarray, slot: np.ndarray | int) -> None:
        """Add triangles of one or several slots."""
        normal, _ = face_normals(vertices, faces)
        slots = np.broadcast_to(slot, (len(faces),))
        for k in np.unique(slots):
            mine = slots == k
            sites = self._sites[int(k)]
            if len(sites) == 1:
                site = np.full(mine.sum(), sites[0])
            elif k == SLEEVE:
                site = np.where(vertices[faces[mine]].mean(axis=(1))[:, 1] < 0, sites[0], sites[1])
            else:
                site = np.where(normal[mine, 0] >= 0, sites[0], sites[1])
            used, faces_k = np.unique(faces[mine], return_inverse=True)
            corner = np.repeat(site[:, None], 3, axis=1)
            self.model.mesh(vertices[used], faces_k.reshape(-1, 3), int(k), Semantic.PERSON, corner)

    def limb(
        self, centre: np.ndarray, radii: np.ndarray, points: int, slots: np.ndarray, lids: str = ""
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
        self.add(rings.reshape(-1, 3), faces, slot)


def _along(start: np.ndarray, end: np.ndarray, *share: float) -> np.ndarray:
    return np.asarray(start + np.array(share)[:, None] * (end - start))


def _trunk(sculptor: _Sculptor, joints: Pose) -> None:
    centre = _along(joints.pelvis, joints.neck, -0.13, 0.0, 0.28, 0.62, 0.86, 1.0)
    radii = np.array(
        [[0.10, 0.08], [0.165, 0.12], [0.138, 0.1], [0.165, 0.122], [0.175, 0.098], [0.07, 0.06]]
    )
    sculptor.limb(centre, radii, 10, np.array([BOTTOM, BOTTOM, TOP, TOP, TOP]), "se")


def _head(sculptor: _Sculptor, joints: Pose, size: float) -> None:
    tilt = np.array([0.4 * np.sin(joints.lean_rad), 0.0, 1.0])
    neck = _along(joints.neck - 0.03 * tilt, joints.neck + 0.07 * tilt, 0.0, 1.0)
    sculptor.limb(neck, np.array([[0.062, 0.062], [0.055, 0.06]]), 8, np.array([SKIN]))
    level = size * np.array([0.0, 0.035, 0.095, 0.15, 0.205, 0.225])
    forward = size * np.array([0.03, 0.025, 0.015, 0.01, 0.002, 0.0])
    centre = joints.neck + 0.035 * tilt + level[:, None] * tilt + forward[:, None] * [1.0, 0, 0]
    radii = size * np.array(
        [[0.04, 0.055], [0.062, 0.08], [0.075, 0.096], [0.078, 0.1], [0.055, 0.075], [0.02, 0.03]]
    )
    points = 10
    rings = oval_rings(centre, _Y, radii, points)
    faces = np.concatenate(
        [loft_faces(6, points), fan_faces(points, 5 * points), fan_faces(points, flip=True)]
    )
    middle = rings.reshape(-1, 3)[faces].mean(axis=1) - centre[2]
    bald = (middle[:, 0] > 0.012 - 0.2 * middle[:, 2]) & (middle[:, 2] < 0.085 * size)
    low = middle[:, 2] < -0.055 * size
    sculptor.add(rings.reshape(-1, 3), faces, np.where(bald | low, SKIN, HAIR))


def _leg(sculptor: _Sculptor, joints: Pose, k: int) -> None:
    hip, knee, ankle, toe = joints.hip[k], joints.knee[k], joints.ankle[k], joints.toe[k]
    centre = np.concatenate([_along(hip, knee, -0.02, 0.45), _along(knee, ankle, 0.0, 0.32, 0.97)])
    radii = np.array([[0.086, 0.1], [0.076, 0.085], [0.054, 0.06], [0.052, 0.062], [0.038, 0.04]])
    sculptor.limb(centre, radii, 8, np.array([BOTTOM, BOTTOM, SHIN, SHIN]))
    _shoe(sculptor, ankle, toe)


def _shoe(sculptor: _Sculptor, ankle: np.ndarray, toe: np.ndarray) -> None:
    """A wedge from heel to toe under the ankle."""
    ahead = toe - ankle
    sole = np.cross(ahead, _Y)
    sole /= np.linalg.norm(sole)
    forward = np.cross(_Y, sole)
    sections = []
    # Of the way from heel to toe [m], half-width, heights of sole and instep below the ankle.
    for x, half, low, high in (
        (-0.075, 0.033, 0.075, -0.01),
        (0.03, 0.043, 0.075, -0.03),
        (0.12, 0.05, 0.075, 0.02),
        (0.2, 0.03, 0.07, 0.045),
    ):
        corner = ankle + x * forward
        sections.append(
            [
                corner + y * _Y + z * sole
                for y, z in ((half, low), (half * 0.75, high), (-half * 0.75, high), (-half, low))
            ]
        )
    vertices = np.array(sections).reshape(-1, 3)
    faces = np.concatenate([loft_faces(4, 4), fan_faces(4, 0, True), fan_faces(4, 12)])
    normal, _ = face_normals(vertices, faces)
    outward = vertices[faces].mean(axis=1) - vertices.mean(axis=0)
    if (normal * outward).sum() < 0:
        faces = faces[:, ::-1]
    sculptor.add(vertices, faces, SHOE)


def _arm(sculptor: _Sculptor, joints: Pose, k: int) -> None:
    shoulder, elbow, wrist, finger = joints.shoulder[k], joints.elbow[k], joints.wrist[k], joints.finger[k]
    inner = shoulder + np.array([0.0, -0.06 if shoulder[1] > 0 else 0.06, 0.035])
    centre = np.concatenate([inner[None], _along(shoulder, elbow, 0.12, 0.95), _along(wrist, elbow, 0.0)])
    radii = np.array([[0.06, 0.05], [0.052, 0.056], [0.04, 0.043], [0.028, 0.031]])
    sculptor.limb(centre, radii, 6, np.array([TOP, TOP, SLEEVE]), "s")
    hand = _along(wrist, finger, -0.03, 0.5, 1.0)
    sculptor.limb(
        hand, np.array([[0.022, 0.03], [0.02, 0.045], [0.012, 0.025]]), 6, np.array([SKIN, SKIN]), "e"
    )
