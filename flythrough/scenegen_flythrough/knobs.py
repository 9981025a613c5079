"""What a recipe may say about flights."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from scenegen.foundation.section import Count, Number, Section, Span

TOP_SPEED_MPS = 22.2
"""The fastest flight this project is made for (80 km/h)."""


class FlightKnobs(Section):
    """How the camera flies: speed, height and camera angle are drawn per clip, then a smooth path."""

    speed_mps: Span = (3.0, 15.0)
    """Constant speed of a clip [m/s], drawn from this range; above 0 and at most 22.2."""

    height_m: Span = (4.0, 40.0)
    """Height above ground a clip cruises at [m], drawn from this range; 2 to 120."""

    height_slack_m: Annotated[Number, Field(gt=0.0, le=20.0)] = 1.0
    """How far the path may leave `height_m` where the ground is rougher than a drone can follow [m]."""

    spacing_m: Annotated[Number, Field(ge=0.02, le=10.0)] = 1.0
    """Metres flown between two frames."""

    clearance_m: Annotated[Number, Field(gt=0.0, le=10.0)] = 1.0
    """No part of the world comes closer to the path than this [m]; proven for the whole path, not only at frames."""

    pitch_deg: Span = (-20.0, 0.0)
    """Angle of the camera against the airframe [deg], drawn from this range; negative looks down; -90 to 30."""

    turn_radius_m: Annotated[Number, Field(ge=1.0, le=1000.0)] = 8.0
    """Tightest turn [m]; fast flights turn wider, as `bank_deg` allows."""

    bank_deg: Annotated[Number, Field(ge=5.0, le=60.0)] = 25.0
    """Largest tilt of the airframe [deg]; bounds the sideways acceleration."""

    climb_deg: Annotated[Number, Field(ge=0.0, le=45.0)] = 15.0
    """Steepest climb or descent of the path [deg]."""

    max_draws: Annotated[Count, Field(ge=1, le=1_000_000)] = 2048
    """Paths that may be rejected before a flight is given up."""

    @field_validator("speed_mps")
    @classmethod
    def _speed_bounds(cls, value: tuple[float, float]) -> tuple[float, float]:
        if value[0] <= 0.0 or value[1] > TOP_SPEED_MPS:
            raise ValueError(f"speed must be above 0 and at most {TOP_SPEED_MPS:g} m/s, not {_text(value)}")
        return value

    @field_validator("height_m")
    @classmethod
    def _height_bounds(cls, value: tuple[float, float]) -> tuple[float, float]:
        if value[0] < 2.0 or value[1] > 120.0:
            raise ValueError(f"height above ground must lie in 2 to 120 m, not {_text(value)}")
        return value

    @field_validator("pitch_deg")
    @classmethod
    def _pitch_bounds(cls, value: tuple[float, float]) -> tuple[float, float]:
        if value[0] < -90.0 or value[1] > 30.0:
            raise ValueError(f"the camera's angle must lie in -90 (down) to 30 deg, not {_text(value)}")
        return value

    @model_validator(mode="after")
    def _room_above_ground(self) -> FlightKnobs:
        if self.clearance_m >= self.height_m[0]:
            raise ValueError(
                f"clearance_m {self.clearance_m:g} reaches the ground from height_m {self.height_m[0]:g}; "
                "fly higher or ask for less clearance"
            )
        return self


def _text(value: tuple[float, float]) -> str:
    return f"[{value[0]:g}, {value[1]:g}]"
