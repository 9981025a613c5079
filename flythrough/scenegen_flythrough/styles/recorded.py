"""Recorded: flown once before; a stretch of it becomes a clip, where it was flown or anywhere else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.interpolate import PchipInterpolator, make_lsq_spline
from scipy.spatial.transform import Rotation, RotationSpline, Slerp

from scenegen.foundation.errors import InputError
from scenegen_flythrough.flown import Flown
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.quadrotor.attitude import Attitude
from scenegen_flythrough.quadrotor.motion import FlatLeaning, Leaning, Motion
from scenegen_flythrough.quadrotor.mount import body_from_camera
from scenegen_flythrough.quadrotor.nose import follow_heading
from scenegen_flythrough.quadrotor.pilotage import excess_of
from scenegen_flythrough.quadrotor.spline import DEGREE, LEAD, UniformSpline
from scenegen_flythrough.recordings.read import recording_of
from scenegen_flythrough.recordings.recording import Recording
from scenegen_flythrough.steering import free_starts
from scenegen_flythrough.styles.task import Task, between

_DRAWS = 32
_KNOT_S = 0.15
"""Finest detail of the fitted path: what is faster is noise of the record."""


@dataclass(frozen=True, eq=False)
class RecordedLeaning:
    """Leaning as it was recorded.

    Attributes
    ----------
    turned : RotationSpline
        Body to world over the time of the motion.
    aimed : bool
        The body is one that the camera sits on straight: how the airframe leaned below it is not known.
    """

    turned: RotationSpline
    aimed: bool

    def at(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Attitude:
        """Attitude and body rates at instants."""
        return Attitude(np.asarray(self.turned(t).as_matrix()), np.asarray(self.turned(t, 1)))

    def up(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Float64[np.ndarray, "times 3"]:
        """Along the rotor axis, as far as it is known, a unit vector."""
        if self.aimed:
            return np.tile([0.0, 0.0, 1.0], (len(t), 1))
        return np.asarray(self.turned(t).as_matrix()[:, :, 2])


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recording ready to be cut into clips.

    Attributes
    ----------
    knobs : FlightKnobs
    motion : Motion
        All of it.
    aimed : bool
        Orientations are those of the camera.
    """

    knobs: FlightKnobs
    motion: Motion
    aimed: bool

    @staticmethod
    def of(knobs: FlightKnobs) -> Recorded:
        """Fit the recording that the recipe names."""
        wish = knobs.recorded
        recording = recording_of(wish.file, wish.sha256)
        position = _fitted(recording)
        keeps = recording.quaternion is not None and wish.attitude == "recorded"
        leaning: Leaning = (
            _recorded_leaning(recording, camera=wish.camera) if keeps else _flown_leaning(position, knobs)
        )
        return Recorded(knobs, Motion(position, leaning), keeps and wish.camera)

    def draw(self, task: Task, frames: int, rng: np.random.Generator) -> Iterator[Flown | str]:
        """Stretches of the recording, or why one that was drawn cannot be flown.

        Raises
        ------
        InputError
            The recording is shorter than a clip.
        """
        knobs, anywhere = self.knobs, self.knobs.recorded.place == "anywhere"
        need_m = (frames + 1) * knobs.spacing_m
        whole_m = self.motion.length_m
        if whole_m < need_m:
            raise InputError(
                f"{knobs.recorded.file}: {whole_m:.1f} m long, but {frames} frames {knobs.spacing_m:g} m apart take "
                f"{need_m:g} m; ask for fewer pairs or a smaller flight.spacing_m"
            )
        for child in rng.spawn(_DRAWS):
            first_rng, pitch_rng, place_rng = child.spawn(3)
            first_m = float(first_rng.uniform(0.0, whole_m - need_m))
            times = self.motion.times_at_way(first_m, need_m, 2)
            if times is None:
                continue
            motion = _stretch(self.motion, float(times[0]), float(times[1]))
            if (excess_of(motion, knobs.limits) > 1.0).any():
                yield "limits"
                continue
            if anywhere:
                moved = _moved(task, motion, place_rng)
                if moved is None:
                    yield "hopeless"
                    continue
                motion = moved
            pitch = 0.0 if self.aimed else between(knobs.pitch_deg, pitch_rng)
            first_m = float(motion.way_until(float(times[0])))
            yield Flown(motion, pitch, first_m, free_height=not anywhere)


def _fitted(recording: Recording) -> UniformSpline:
    """Least squares of a quintic spline over the whole recording."""
    step = max(_KNOT_S, 2.0 * float(np.median(np.diff(recording.time_s))))
    end = recording.time_s[-1]
    segments = max(int(end / step), 2)
    step = float(end / segments)
    even = np.linspace(0.0, end, 4 * segments + 1)
    place = PchipInterpolator(recording.time_s, recording.place)(even)
    knots = step * np.arange(-DEGREE, segments + DEGREE + 1)
    return UniformSpline(0.0, step, np.asarray(make_lsq_spline(even, place, knots, DEGREE).c, np.float64))


def _recorded_leaning(recording: Recording, *, camera: bool) -> RecordedLeaning:
    quaternion = recording.quaternion
    assert quaternion is not None
    turned = Rotation.from_quat(quaternion)
    if camera:
        turned = Rotation.from_matrix(turned.as_matrix() @ body_from_camera(0.0).T)
    step = max(0.5 * _KNOT_S, float(np.median(np.diff(recording.time_s))))
    even = np.linspace(0.0, recording.time_s[-1], max(int(recording.time_s[-1] / step), 2) + 1)
    return RecordedLeaning(RotationSpline(even, Slerp(recording.time_s, turned)(even)), camera)


def _flown_leaning(position: UniformSpline, knobs: FlightKnobs) -> FlatLeaning:
    """As a quadrotor in calm air leans, the nose following the course."""
    count = len(position.control)
    t = np.clip(position.start + (np.arange(count) - LEAD) * position.step, position.start, position.end)
    ahead = position.at(t, 1)
    wanted = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    heading = follow_heading(wanted, position.step, knobs.limits)[:, None]
    still = np.zeros((count, 3))
    return FlatLeaning(
        UniformSpline(position.start, position.step, heading),
        UniformSpline(position.start, position.step, still),
    )


def _stretch(motion: Motion, start_s: float, end_s: float) -> Motion:
    """The same motion with no more of its spline than these instants need."""
    whole = motion.position
    first = max(int((start_s - whole.start) / whole.step), 0)
    last = min(int((end_s - whole.start) / whole.step) + 1 + DEGREE, len(whole.control))
    first = min(first, last - DEGREE - 1)
    return Motion(
        UniformSpline(whole.start + first * whole.step, whole.step, whole.control[first:last]), motion.leaning
    )


def _moved(task: Task, motion: Motion, rng: np.random.Generator) -> Motion | None:
    """The motion turned about the vertical and begun at a free place and height."""
    knobs, air = task.knobs, task.airspace
    height_rng, place_rng, turn_rng = rng.spawn(3)
    height = between(knobs.height_m, height_rng)
    start = free_starts(air, air.room(height, knobs.clearance_m + 1.0), knobs, 1, place_rng)
    if len(start) == 0:
        return None
    angle = float(turn_rng.uniform(0.0, 2 * np.pi))
    turn = Rotation.from_rotvec([0.0, 0.0, angle])
    control = motion.position.control
    lift = np.array([*start[0], air.world.ground.at(start)[0] + height])
    moved = (control - control[LEAD]) @ turn.as_matrix().T + lift
    position = UniformSpline(motion.position.start, motion.position.step, np.asarray(moved))
    leaning = motion.leaning
    if isinstance(leaning, FlatLeaning):
        heading = leaning.heading
        leaning = FlatLeaning(
            UniformSpline(heading.start, heading.step, heading.control + angle), leaning.wind
        )
    elif isinstance(leaning, RecordedLeaning):
        times = leaning.turned.times
        leaning = RecordedLeaning(RotationSpline(times, turn * leaning.turned(times)), leaning.aimed)
    return Motion(position, leaning)
