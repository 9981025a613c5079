"""What a recipe may say about closed-loop flights."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from scenegen.foundation.section import Number, Section, Span, within
from scenegen_flythrough.quadrotor.limits import TOP_SPEED_MPS


class DroneLimits(Section):
    """What the airframe can do. All limits hold at every instant, gusts included."""

    speed_mps: Annotated[Number, Field(gt=0.0, le=TOP_SPEED_MPS)] = 12.0
    """Fastest flight in any direction [m/s]."""

    acceleration_mps2: Annotated[Number, Field(gt=0.1, le=50.0)] = 6.0
    """Largest acceleration in any direction [m/s^2]; 6 asks for a tilt of 31 deg."""

    jerk_mps3: Annotated[Number, Field(ge=5.0, le=1000.0)] = 60.0
    """How fast the acceleration follows the controller [m/s^3]: a tenth of a second from rest to full."""

    yaw_rate_dps: Annotated[Number, Field(gt=1.0, le=720.0)] = 120.0
    """Fastest turn of the nose [deg/s]."""


class WindKnobs(Section):
    """Wind a flight meets; its direction and gusts are drawn per flight."""

    mean_mps: Annotated[Number, Field(ge=0.0, le=20.0)] = 3.0
    """Mean wind [m/s]. The autopilot trims against it: it costs nothing but sets the scale of the gusts."""

    turbulence: Annotated[Number, Field(ge=0.0, le=0.5)] = 0.15
    """Standard deviation of each component of the gusts, as a share of the mean wind; 0.15 over open land."""


class LoopKnobs(Section):
    """One step of the closed loop."""

    radius_m: Annotated[Number, Field(ge=0.05, le=2.0)] = 0.35
    """Radius of the sphere that stands for the drone [m]."""

    decision_s: Annotated[Number, Field(ge=0.02, le=2.0)] = 0.2
    """Time from frame to frame, and so from decision to decision [s]."""

    latency: Literal["fixed", "measured"] = "fixed"
    """Delay from frame to command: `fixed` is the same on any machine; `measured` is what the pilot took."""

    latency_ms: Annotated[Number, Field(ge=0.0, le=2000.0)] = 100.0
    """The fixed delay [ms]."""

    patience_s: Annotated[Number, Field(ge=0.1, le=3600.0)] = 120.0
    """A pilot that needs longer than this for one answer has stalled, and its flights have failed [s]."""

    goal_radius_m: Annotated[Number, Field(ge=0.2, le=20.0)] = 2.5
    """A flight that comes this near to its goal has reached it [m]."""

    time_factor: Annotated[Number, Field(ge=1.0, le=100.0)] = 4.0
    """Time allowed, in multiples of the straight way at `cruise_mps`."""

    cruise_mps: Annotated[Number, Field(gt=0.0, le=TOP_SPEED_MPS)] = 6.0
    """Speed planners cruise at [m/s]."""

    mount_pitch_deg: Annotated[Number, Field(ge=-90.0, le=30.0)] = 0.0
    """Angle of the camera against the horizon, or the airframe [deg]; negative looks down."""

    stabilised: bool = True
    """The camera hangs in a gimbal and keeps level; else it tilts with the airframe."""

    drone: DroneLimits = DroneLimits()
    wind: WindKnobs = WindKnobs()


class MissionKnobs(Section):
    """Where flights start and where they want to go."""

    difficulty: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.6
    """Share of the missions whose straight way from start to goal is obstructed."""

    distance_m: Annotated[Number, Field(ge=5.0, le=2000.0)] = 100.0
    """From start to goal, in the plan [m]."""

    height_m: Annotated[Span, within(1.0, 120.0)] = (4.0, 12.0)
    """Heights above ground of start and goal [m], drawn from this range."""

    climb_m: Annotated[Number, Field(ge=0.0, le=200.0)] = 12.0
    """How far above the higher of start and goal a flight may climb [m]."""

    clearance_m: Annotated[Number, Field(ge=0.5, le=20.0)] = 2.0
    """Free space around start and goal [m]."""
