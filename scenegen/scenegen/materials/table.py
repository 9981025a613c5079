"""The material table: one row per material, each with its sources, read once from the packaged CSV.

Sources in the last column: E = computed from ECOSTRESS/ASTER spectra (band mean at 300 K, AM1.5 global for the sun),
A = ASHRAE 2005 Handbook of Fundamentals, S = SOLWEIG defaults, U = UWG defaults, R = Fresnel from published n and k,
F = EnergyPlus material names of the ASHRAE rows, M = engineering judgement. Texture amplitudes are ours: set so that
synthetic frames match the local contrast of real aerial LWIR frames.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from scenegen.foundation.errors import InputError, nearest
from scenegen.materials.material import Build, ComplexIndex, Material


@cache
def materials() -> Mapping[str, Material]:
    """All materials by name, in id order."""
    text = files("scenegen.materials").joinpath("table.csv").read_text(encoding="utf-8")
    rows = [_material(row) for row in csv.DictReader(text.splitlines())]
    return MappingProxyType({m.name: m for m in rows})


def material(name: str) -> Material:
    """Look one material up.

    Raises
    ------
    InputError
        If there is no such material; names the nearest one.
    """
    try:
        return materials()[name]
    except KeyError:
        raise InputError(f"unknown material '{name}'{nearest(name, materials())}") from None


def _material(row: dict[str, str]) -> Material:
    index = ComplexIndex(float(row["mirror_n"]), float(row["mirror_k"])) if row["mirror_n"] else None
    return Material(
        id=int(row["id"]),
        name=row["name"],
        emissivity=float(row["emissivity"]),
        emissivity_range=(float(row["emissivity_low"]), float(row["emissivity_high"])),
        solar_absorptance=float(row["solar_absorptance"]),
        density_kgm3=float(row["density_kgm3"]),
        heat_capacity_JkgK=float(row["heat_capacity_JkgK"]),
        conductivity_WmK=float(row["conductivity_WmK"]),
        thickness_m=float(row["thickness_m"]),
        roughness_factor=float(row["roughness_factor"]),
        build=Build(row["build"]),
        mirror=index,
        mirror_reflectance=float(row["mirror_reflectance"]) if row["mirror_reflectance"] else None,
        wetness=float(row["wetness"]),
        stomatal_resistance_sm=float(row["stomatal_resistance_sm"]),
        direct_factor=float(row["direct_factor"]),
        convection_factor=float(row["convection_factor"]),
        max_temperature_K=float(row["max_temperature_K"]),
        texture_K=float(row["texture_K"]),
        texture_scale_m=float(row["texture_scale_m"]),
        source=row["source"],
    )
