"""The spectral bands this project knows, with the coefficients that were fitted for each.

Planck integrals work for any band; in-band sky emissivity, path transmission and effective indices are fits to
line-by-line-like models (LOWTRAN 7, checked against RRTMGP) and exist for these two bands only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from scenegen.foundation.errors import InputError
from scenegen.materials.material import ComplexIndex, Material


@dataclass(frozen=True)
class SkyFit:
    """Clear-sky emissivity ``1 - (1 - f0) exp(-(c0 + c1 e + c2 e^2) m^b)``, e vapour pressure [hPa], m air mass.

    Fitted to LOWTRAN 7 (6 atmospheres x 12 angles): rms 0.017, largest error 0.045.
    """

    f0: float
    c0: float
    c1: float
    c2: float
    b: float


@dataclass(frozen=True)
class PathFit:
    """Transmission ``sum_i a_i exp(-(k0_i + k1_i rho + k2_i rho^2) R)``, R [km], rho absolute humidity [g/m^3].

    Fitted to 336 horizontal LOWTRAN 7 runs (-10..40 C, rho < 30 g/m^3, 10 m - 3 km): rms 0.0042, largest 0.027.
    """

    a: tuple[float, float, float]
    k0: tuple[float, float, float]
    k1: tuple[float, float, float]
    k2: tuple[float, float, float]


@dataclass(frozen=True)
class Band:
    """One spectral band of a camera.

    Attributes
    ----------
    limits_um : (float, float)
        Wavelengths [um].
    sky : SkyFit
    path : PathFit
    index : mapping of material name to ComplexIndex
        Effective indices whose Fresnel reflectance reproduces the spectral average over this band (water:
        Hale and Querry 1973; soda-lime glass: Rubin 1985; largest emissivity error 0.0008 and 0.012).
    """

    limits_um: tuple[float, float]
    sky: SkyFit
    path: PathFit
    index: Mapping[str, ComplexIndex]


BANDS: Mapping[tuple[float, float], Band] = MappingProxyType(
    {
        (8.0, 14.0): Band(
            limits_um=(8.0, 14.0),
            sky=SkyFit(f0=0.1199, c0=0.0776, c1=0.01234, c2=0.000307, b=0.7876),
            path=PathFit(
                a=(0.7992, 0.1607, 0.0401),
                k0=(0.0, 0.3885, 10.19),
                k1=(0.007159, 0.09772, 1.63),
                k2=(7.676e-4, 1.700e-3, 0.0),
            ),
            index=MappingProxyType(
                {
                    "water_fresh_or_sea": ComplexIndex(1.2388, 0.1419),
                    "window_glass": ComplexIndex(1.3064, 0.8157),
                }
            ),
        ),
        (7.5, 13.5): Band(
            limits_um=(7.5, 13.5),
            sky=SkyFit(f0=0.0881, c0=0.0845, c1=0.01426, c2=0.000275, b=0.7578),
            path=PathFit(
                a=(0.7908, 0.1696, 0.0396),
                k0=(5.153e-4, 0.2418, 3.80),
                k1=(0.006886, 0.1227, 3.435),
                k2=(7.712e-4, 1.503e-3, 0.0),
            ),
            index=MappingProxyType(
                {
                    "water_fresh_or_sea": ComplexIndex(1.2306, 0.1312),
                    "window_glass": ComplexIndex(1.3888, 0.7871),
                }
            ),
        ),
    }
)
"""All bands, by their limits [um]."""


def band(limits_um: tuple[float, float]) -> Band:
    """Look a band up by its limits [um].

    Raises
    ------
    InputError
        If sky and path are not known in that band.
    """
    try:
        return BANDS[(float(limits_um[0]), float(limits_um[1]))]
    except KeyError:
        known = " and ".join(f"{low:g}-{high:g}" for low, high in BANDS)
        raise InputError(
            f"no sky and path data for the band {limits_um[0]:g}-{limits_um[1]:g} um; choose one of {known} um"
        ) from None


def mirror_index(material: Material, limits_um: tuple[float, float]) -> ComplexIndex | None:
    """Effective index of a smooth dielectric in a band; None where the material has no mirror.

    Materials without an own fit in the band keep the index of the material table (8-14 um).
    """
    if material.mirror is None:
        return None
    return band(limits_um).index.get(material.name, material.mirror)
