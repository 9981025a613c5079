"""What a recipe may say about flights."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, field_validator, model_validator

from scenegen.foundation.errors import nearest
from scenegen.foundation.section import Count, Number, Section, Span, within
from scenegen_flythrough.quadrotor.imu import ImuKnobs
from scenegen_flythrough.quadrotor.limits import TOP_SPEED_MPS, QuadrotorLimits
from scenegen_flythrough.styles.knobs import (
    ApproachKnobs,
    CorridorKnobs,
    OrbitKnobs,
    RecordedKnobs,
    SurveyKnobs,
    TerrainFollowKnobs,
    WaypointsKnobs,
)

STYLES = (
    "explore",
    "corridor",
    "survey",
    "orbit",
    "terrain_follow",
    "waypoints",
    "approach",
    "recorded",
)
"""Names of all styles; `scenegen_flythrough.styles.registry` knows who flies them."""


def _one_or_many(value: Any) -> Any:
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_one_or_many)]


class FlightKnobs(Section):
    """How the camera flies: style, speed, height and camera angle are drawn per clip, then a path, then the wind."""

    styles: Names = (
        "explore",
        "explore",
        "waypoints",
        "corridor",
        "terrain_follow",
        "orbit",
        "survey",
        "approach",
    )
    """Kinds of flights; each clip draws one of these entries with equal chance, so a style named twice is flown twice
    as often. Where a world has no place for it, the clip draws again among the others."""

    speed_mps: Span = (3.0, 15.0)
    """Cruise speed of a clip [m/s], drawn from this range; bends are flown more slowly. Above 0 and at most 22.2."""

    height_m: Span = (4.0, 40.0)
    """Height above ground a clip cruises at [m], drawn from this range; 2 to 120."""

    height_slack_m: Annotated[Number, Field(gt=0.0, le=20.0)] = 1.0
    """How far the path may leave `height_m` where the ground is rougher than a drone can follow [m]."""

    spacing_m: Annotated[Number, Field(ge=0.02, le=10.0)] = 1.0
    """Metres flown between two frames; how long they take depends on the speed."""

    clearance_m: Annotated[Number, Field(gt=0.0, le=10.0)] = 1.0
    """No part of the world comes closer to the path than this [m]; proven for the whole path, not only at frames."""

    pitch_deg: Span = (-20.0, 0.0)
    """Angle of the camera against the airframe [deg], drawn from this range; negative looks down; -90 to 30."""

    turn_radius_m: Annotated[Number, Field(ge=1.0, le=1000.0)] = 8.0
    """Tightest turn of a flight that explores [m]; fast flights turn wider, as `bank_deg` allows."""

    bank_deg: Annotated[Number, Field(ge=5.0, le=60.0)] = 25.0
    """How far flights lean into bends [deg]; `limits.tilt_deg` bounds the lean from all causes together."""

    climb_deg: Annotated[Number, Field(ge=0.0, le=45.0)] = 15.0
    """Steepest climb or descent of the path [deg]."""

    wind_mps: Annotated[Span, within(0.0, 15.0)] = (0.0, 6.0)
    """Mean wind [m/s], drawn from this range, with gusts to match: they lean the drone and push it off a little."""

    vibration_mrad: Annotated[Number, Field(ge=0.0, le=20.0)] = 0.3
    """Shaking of the camera on its mount, root mean square about each axis [mrad]."""

    limits: QuadrotorLimits = QuadrotorLimits()
    imu: ImuKnobs = ImuKnobs()
    corridor: CorridorKnobs = CorridorKnobs()
    survey: SurveyKnobs = SurveyKnobs()
    orbit: OrbitKnobs = OrbitKnobs()
    terrain_follow: TerrainFollowKnobs = TerrainFollowKnobs()
    waypoints: WaypointsKnobs = WaypointsKnobs()
    approach: ApproachKnobs = ApproachKnobs()
    recorded: RecordedKnobs = RecordedKnobs()

    max_draws: Annotated[Count, Field(ge=1, le=1_000_000)] = 2048
    """Paths that may be rejected before a flight is given up."""

    @field_validator("styles")
    @classmethod
    def _known_styles(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if not value:
            raise ValueError(f"name at least one style; known: {', '.join(STYLES)}")
        for name in value:
            if name not in STYLES:
                raise ValueError(f"unknown style '{name}'{nearest(name, STYLES)}")
        return value

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
        if "recorded" in self.styles and not self.recorded.file and not self.recorded.sha256:
            raise ValueError("style 'recorded' needs a file; give recorded.file")
        return self


def _text(value: tuple[float, float]) -> str:
    return f"[{value[0]:g}, {value[1]:g}]"
