"""What one material is, radiatively and thermally."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Build(StrEnum):
    """What lies behind the visible layer; decides the layers and the inner boundary of the heat conduction."""

    GROUND = "ground"
    WALL_INSULATED = "wall_ins"
    ROOF_INSULATED = "roof_ins"
    ROOF_VENTILATED = "roof_vent"
    WINDOW = "window"
    PANEL = "panel"
    CANOPY_GROUND = "canopy_ground"
    LEAF = "leaf"
    SOLID = "solid"
    VEHICLE = "vehicle"
    HUMAN = "human"
    WATER = "water"


@dataclass(frozen=True)
class ComplexIndex:
    """Effective complex refractive index n + ik of a smooth dielectric over one band (physics: one pair per band)."""

    n: float
    k: float


@dataclass(frozen=True)
class Material:
    """One row of the material table.

    Attributes
    ----------
    id : int
        Fixed number stored in the `material` layer; never reused. User materials start at 1000.
    name : str
    emissivity : float
        Band emissivity 8-14 um at near-normal view, typical value.
    emissivity_range : tuple of float
        Measured spread; a world draws its variants inside it.
    solar_absorptance : float
    density_kgm3, heat_capacity_JkgK, conductivity_WmK, thickness_m : float
        Of the visible layer.
    roughness_factor : float
        R_f of the DOE-2 convection model, 1.0 (very smooth) to 2.17 (very rough).
    build : Build
    mirror : ComplexIndex or None
        Index of a smooth dielectric, for which the tracer follows one Fresnel mirrored ray.
    mirror_reflectance : float or None
        Constant reflectance of a bare metal, mirrored likewise (1 - emissivity); None for all others.
    wetness : float
        Share of the surface that evaporates, 0..1.
    stomatal_resistance_sm : float
        r_s [s/m]; meaningful where wetness > 0.
    direct_factor : float
        Share of the direct beam that the effective surface absorbs (leaves shade each other).
    convection_factor : float
        Multiplier of h (leaves: small, both sides).
    max_temperature_K : float
        Clamp of the solution (snow, ice: 273.15); infinity elsewhere.
    texture_K : float
        Amplitude (about one standard deviation) of the surface's small-scale temperature variation in full sun [K].
    texture_scale_m : float
        Size of its largest octave [m].
    source : str
        Where emissivity, absorptance and thermal data come from.
    """

    id: int
    name: str
    emissivity: float
    emissivity_range: tuple[float, float]
    solar_absorptance: float
    density_kgm3: float
    heat_capacity_JkgK: float
    conductivity_WmK: float
    thickness_m: float
    roughness_factor: float
    build: Build
    mirror: ComplexIndex | None
    mirror_reflectance: float | None
    wetness: float
    stomatal_resistance_sm: float
    direct_factor: float
    convection_factor: float
    max_temperature_K: float
    texture_K: float
    texture_scale_m: float
    source: str


@dataclass(frozen=True)
class Surface:
    """A material variant as one world has it: one entry of the world's palette.

    Attributes
    ----------
    material : Material
    emissivity, solar_absorptance : float
        Drawn inside the material's measured ranges.
    interior_K : float
        Temperature behind the layers [K] (heated room, engine bay); NaN where the build has no inner side.
    prescribed_K : float
        A fixed surface temperature [K] that bypasses the heat balance (water, test scenes); NaN elsewhere.
    released_Wm2 : float
        Heat set free behind the layers [W/m^2] (the flexing of a rolling tyre).
    """

    material: Material
    emissivity: float
    solar_absorptance: float
    interior_K: float = float("nan")
    prescribed_K: float = float("nan")
    released_Wm2: float = 0.0
