"""The sidecar of a scene: which way is up, how long a unit is, what its parts are made of and what they are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError
from pydantic_core import ErrorDetails

from scenegen.classes import CLASSES, Semantic
from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.section import Number, Section
from scenegen.foundation.strict_yaml import read_mapping
from scenegen.materials.table import material


class Prescribed(Section):
    """A surface of given temperature, which neither sun nor air changes: a test body, a radiator, a heated wall."""

    temperature_K: Annotated[Number, Field(ge=180.0, le=420.0)]
    """Kinetic temperature [K], 180 to 420."""
    emissivity: Annotated[Number, Field(gt=0.0, le=1.0)]
    """Band emissivity; it is matt."""


def _choice(value: Any) -> Any:
    if isinstance(value, str):
        return material(value).name
    if isinstance(value, Prescribed):
        return value
    if not isinstance(value, Mapping):
        raise ValueError(
            f"{value!r} is neither a material ('scenegen materials') nor a mapping like "
            "{temperature_K: 300, emissivity: 0.9}"
        )
    unknown = set(value) - set(Prescribed.model_fields)
    missing = set(Prescribed.model_fields) - set(value)
    if unknown or missing:
        raise ValueError(f"takes temperature_K and emissivity, not {', '.join(map(str, value)) or 'nothing'}")
    return Prescribed.model_validate(value)


def _class(value: Any) -> Any:
    if isinstance(value, Semantic):
        return value
    names = {row.name: row.id for row in CLASSES if row.id != Semantic.SKY}
    if value not in names:
        raise ValueError(f"unknown class '{value}'{nearest(str(value), names)}")
    return names[value]


def _area(value: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    west, south, east, north = value
    if east - west < 1.0 or north - south < 1.0:
        raise ValueError("takes west, south, east, north in metres, at least 1 m apart")
    return value


Area = Annotated[tuple[Number, Number, Number, Number], AfterValidator(_area)]

Choice = Annotated[str | Prescribed, BeforeValidator(_choice)]
"""The name of a material, or a prescribed temperature and emissivity."""

ClassName = Annotated[Semantic, BeforeValidator(_class)]


class Sidecar(Section):
    """What a scene file does not say about itself. Names are those of nodes, meshes or materials in the file; where
    several apply, a node's wins over a mesh's, and a mesh's over a material's.
    """

    up_axis: Literal["z", "y"] | None = None
    """Which axis of the file points up; by default y in glTF, as its specification has it, z elsewhere."""
    unit_m: Annotated[Number, Field(ge=1e-4, le=1e4)] = 1.0
    """Metres in one unit of the file."""
    materials: dict[str, Choice] = Field(default_factory=dict)
    """What each named part is made of."""
    default_material: Choice | None = None
    """What all others are made of; without it, every part has to be named."""
    classes: dict[str, ClassName] = Field(default_factory=dict)
    """Which class each named part belongs to; by default that of its material."""
    flight_area_m: Area | None = None
    """Where flights stay: west, south, east, north [m], after `up_axis` and `unit_m`; by default the whole scene."""
    flight_ceiling_m: Annotated[Number, Field(ge=5.0, le=500.0)] = 120.0
    """Upper edge of the airspace above the lowest ground [m]; its sides are the scene's own."""


def read_sidecar(path: Path | None) -> Sidecar:
    """Read a sidecar; none is an empty one.

    Raises
    ------
    InputError
        For the first thing that is wrong, in one line with file and key.
    """
    if path is None:
        return Sidecar()
    try:
        return Sidecar.model_validate(read_mapping(path))
    except ValidationError as error:
        details = error.errors(include_url=False)
        first = min(details, key=lambda d: d["type"] != "extra_forbidden")
        more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
        raise InputError(f"{path}: {_line(first)}{more}") from None


def _line(detail: ErrorDetails) -> str:
    keys = [str(part) for part in detail["loc"]]
    where = ": ".join(key for key in keys if key not in ("str", "Prescribed"))
    if detail["type"] == "extra_forbidden":
        return f"{where}: unknown key{nearest(keys[-1], Sidecar.model_fields)}"
    if detail["type"] == "value_error":
        return f"{where}: {' '.join(str(detail['ctx']['error']).split())}"
    message = detail["msg"].replace("Input should be", "must be").replace("valid ", "")
    return f"{where}: {message}, not {str(detail['input'])[:60]!r}"
