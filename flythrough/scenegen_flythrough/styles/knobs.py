"""What a recipe may say about single styles of flight."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, model_validator

from scenegen.foundation.section import Number, Section, Span, within


class CorridorKnobs(Section):
    """Down a street canyon, a lane between hedges or rows of trees, in its middle."""

    width_m: Annotated[Span, within(4.0, 80.0)] = (6.0, 40.0)
    """Free width between what stands left and right [m]."""

    height_m: Annotated[Span, within(2.0, 120.0)] = (3.0, 14.0)
    """Height above ground [m], as far as `flight.height_m` allows it."""


class SurveyKnobs(Section):
    """A lawn-mower over a rectangle: parallel lanes, half circles between them."""

    lane_m: Annotated[Span, within(2.0, 200.0)] = (8.0, 20.0)
    """Distance between lanes [m]."""

    length_m: Annotated[Span, within(5.0, 2000.0)] = (20.0, 60.0)
    """Length of a lane [m]."""

    pitch_deg: Annotated[Span, within(-90.0, 30.0)] = (-40.0, -15.0)
    """Angle of the camera against the airframe [deg]; a survey looks down more than other flights."""


class OrbitKnobs(Section):
    """Around a house or a tree, the nose on it all the time."""

    radius_m: Annotated[Span, within(3.0, 500.0)] = (12.0, 45.0)
    """Of the circle [m]."""


class TerrainFollowKnobs(Section):
    """Close over whatever stands on the ground: up over houses and trees, down behind them."""

    height_m: Annotated[Span, within(1.0, 60.0)] = (3.0, 10.0)
    """Above ground, roofs and crowns [m]."""


class WaypointsKnobs(Section):
    """From one free point to the next, in all three directions."""

    leg_m: Annotated[Span, within(5.0, 500.0)] = (14.0, 40.0)
    """Way from one to the next [m]."""

    turn_deg: Annotated[Number, Field(ge=0.0, le=150.0)] = 100.0
    """Sharpest turn at a waypoint [deg]."""


class ApproachKnobs(Section):
    """Towards an obstacle, slower and slower, and stop in front of it."""

    stop_m: Annotated[Span, within(1.0, 50.0)] = (2.0, 6.0)
    """How near [m]; never nearer than `flight.clearance_m`."""

    brake_mps2: Annotated[Number, Field(ge=0.1, le=10.0)] = 1.5
    """Deceleration [m/s^2]."""


class RecordedKnobs(Section):
    """A flight that somebody flew, from a file; see docs/flights.md for the formats."""

    file: Annotated[str, StringConstraints(max_length=4096)] = ""
    """Path of a .csv, .tum or .ulg file. Empty where a recipe is read back from a dataset."""

    sha256: Annotated[str, StringConstraints(pattern=r"[0-9a-f]{64}|")] = ""
    """Of the file; filled in when the recipe is read. A file that differs from it is refused."""

    place: Literal["as_is", "anywhere"] = "as_is"
    """`as_is`: coordinates are those of the world (east, north, up); `anywhere`: moved and turned about the vertical, a
    new place for every draw, at a height of `flight.height_m`."""

    attitude: Literal["recorded", "flown"] = "recorded"
    """`recorded`: as the file says, if it does; `flown`: as a quadrotor leans that flies this path."""

    camera: bool = False
    """Orientations in the file are those of the camera (x right, y down, z ahead), not of the airframe."""

    @model_validator(mode="before")
    @classmethod
    def _identify(cls, values: object) -> object:
        """Read the file once, so that a bad one is told at once and its content becomes part of the recipe."""
        if not isinstance(values, dict) or not isinstance(values.get("file"), str) or not values["file"]:
            return values
        from scenegen_flythrough.recordings.read import identity

        content = identity(values["file"])
        if values.get("sha256") not in (None, "", content):
            raise ValueError(f"{values['file']} is not the recording this recipe was made with")
        return {**values, "sha256": content}
