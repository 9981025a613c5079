"""What the quadrotor can do. No flight ever asks for more."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section

GRAVITY_MPS2 = 9.80665
TOP_SPEED_MPS = 22.2
"""The fastest flight this project is made for (80 km/h)."""


class QuadrotorLimits(Section):
    """Bounds that hold at every instant of a flight, gusts included.

    The defaults are those of a camera drone of one to three kilograms in a brisk automatic mode.
    """

    speed_mps: Annotated[Number, Field(gt=0.0, le=40.0)] = TOP_SPEED_MPS
    """Largest speed over ground [m/s]."""

    acceleration_mps2: Annotated[Number, Field(ge=0.5, le=30.0)] = 7.0
    """Largest acceleration in any direction [m/s^2], weight not counted."""

    jerk_mps3: Annotated[Number, Field(ge=1.0, le=500.0)] = 20.0
    """Largest change of the acceleration in a second [m/s^3]."""

    tilt_deg: Annotated[Number, Field(ge=5.0, le=80.0)] = 45.0
    """Largest angle between the rotor axis and the vertical [deg]."""

    yaw_rate_dps: Annotated[Number, Field(ge=1.0, le=720.0)] = 90.0
    """Largest rate at which the nose turns about the vertical [deg/s]."""

    yaw_acceleration_dps2: Annotated[Number, Field(ge=5.0, le=5000.0)] = 240.0
    """Largest change of that rate in a second [deg/s^2]."""
