"""In-band sky and path against LOWTRAN 7 tables, which neither fit may leave by more than its stated error."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.band import band, mirror_index
from scenegen.radiometry.path import aerosol_per_km, path_terms
from scenegen.radiometry.planck import band_radiance
from scenegen.radiometry.sky import clear_sky_emissivity, sky_radiance

BAND = (8.0, 14.0)

LOWTRAN_SKY = {
    # name: (T_air [K], e [hPa], emissivity at zenith angle 0, 60, 80, 90 deg)
    "tropical": (299.7, 26.2, (0.520, 0.696, 0.900, 0.970)),
    "mid-latitude summer": (294.2, 19.1, (0.421, 0.584, 0.834, 0.977)),
    "subarctic summer": (287.2, 12.0, (0.331, 0.465, 0.712, 0.971)),
    "US standard": (288.2, 7.9, (0.256, 0.356, 0.563, 0.964)),
    "mid-latitude winter": (272.2, 4.4, (0.227, 0.309, 0.479, 0.966)),
    "subarctic winter": (257.2, 1.4, (0.203, 0.268, 0.395, 0.868)),
}

LOWTRAN_PATH = {
    # (T [C], absolute humidity [g/m^3]): transmission at 50, 100, 300, 1000, 3000 m
    (0, 2.4): (0.9732, 0.9603, 0.9274, 0.8653, 0.7739),
    (20, 1.7): (0.9735, 0.9609, 0.9295, 0.8726, 0.7939),
    (20, 8.6): (0.9581, 0.9367, 0.8787, 0.7579, 0.5652),
    (20, 15.6): (0.9411, 0.9076, 0.8115, 0.6066, 0.3215),
    (30, 15.2): (0.9417, 0.9094, 0.8179, 0.6239, 0.3479),
    (30, 27.3): (0.9048, 0.8452, 0.6755, 0.3662, 0.0948),
}


@pytest.mark.parametrize("name", LOWTRAN_SKY)
def test_clear_sky_follows_lowtran(name):
    air, e, expected = LOWTRAN_SKY[name]
    sine = np.cos(np.radians([0.0, 60.0, 80.0, 90.0]))
    ours = clear_sky_emissivity(sine, Atmosphere(air_K=air, vapour_pressure_hPa=e), BAND)
    np.testing.assert_allclose(ours, expected, atol=0.045)
    assert (np.diff(ours) > 0.0).all()


@pytest.mark.parametrize(
    ("e", "expected"), [(4.4, 0.290), (7.9, 0.348), (12.0, 0.417), (19.0, 0.533), (26.0, 0.641)]
)
def test_hemispheric_emissivity(e, expected):
    mu2 = (np.arange(4000) + 0.5) / 4000  # equal steps of sine squared are the cosine weighting
    sky = clear_sky_emissivity(np.sqrt(mu2), Atmosphere(air_K=290.0, vapour_pressure_hPa=e), BAND)
    assert sky.mean() == pytest.approx(expected, abs=4e-3)


def test_clouds_lift_the_sky_to_the_cloud_base_and_never_beyond_air():
    clear = Atmosphere(air_K=290.0, vapour_pressure_hPa=12.0, cloud_K=284.0)
    overcast = Atmosphere(air_K=290.0, vapour_pressure_hPa=12.0, cloud_K=284.0, cloud_fraction=1.0)
    sine = np.array([0.05, 0.3, 1.0])
    lifted = sky_radiance(sine, overcast, BAND)
    assert (lifted > sky_radiance(sine, clear, BAND)).all()
    low, high = band_radiance(np.array([284.0, 290.0]), BAND)
    assert (lifted > low).all()
    assert (lifted < high).all()


def test_below_the_horizon_is_ground_at_air_temperature():
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=12.0)
    np.testing.assert_allclose(
        sky_radiance(np.array([-1.0, -0.01]), air, BAND),
        band_radiance(np.array([290.0, 290.0]), BAND),
        rtol=1e-14,
    )


def test_a_uniform_sky_replaces_everything():
    sky = Atmosphere(air_K=290.0, vapour_pressure_hPa=12.0, cloud_fraction=0.5, uniform_sky_K=250.0)
    np.testing.assert_allclose(
        sky_radiance(np.array([-0.5, 0.0, 1.0]), sky, BAND),
        band_radiance(np.full(3, 250.0), BAND),
        rtol=1e-14,
    )


@pytest.mark.parametrize("case", LOWTRAN_PATH, ids=str)
def test_path_follows_lowtran(case):
    celsius, rho = case
    air = celsius + 273.15
    atmosphere = Atmosphere(air_K=air, vapour_pressure_hPa=rho * air / 216.68, visibility_km=1e9)
    tau = path_terms(atmosphere, BAND).transmission(np.array([50.0, 100.0, 300.0, 1000.0, 3000.0]))
    np.testing.assert_allclose(tau, LOWTRAN_PATH[case], atol=0.027)
    np.testing.assert_allclose(tau[:3], LOWTRAN_PATH[case][:3], atol=0.0075)


@pytest.mark.parametrize("limits", [(8.0, 14.0), (7.5, 13.5)])
def test_path_is_one_at_zero_and_falls_forever(limits):
    terms = path_terms(Atmosphere(air_K=300.0, vapour_pressure_hPa=30.0), limits)
    tau = terms.transmission(np.array([0.0, 1.0, 10.0, 1e3, 1e4, 1e5]))
    assert tau[0] == pytest.approx(1.0, abs=1e-12)
    assert (np.diff(tau) < 0.0).all()
    assert (tau >= 0.0).all()


def test_an_isothermal_path_changes_nothing():
    terms = path_terms(Atmosphere(air_K=300.0, vapour_pressure_hPa=20.0), BAND)
    L = band_radiance(np.full(4, 300.0), BAND)
    np.testing.assert_allclose(terms.through(L, np.array([0.0, 30.0, 1e3, 1e6])), L, rtol=1e-12)


def test_a_vacuum_is_transparent():
    terms = path_terms(Atmosphere(air_K=300.0, vapour_pressure_hPa=20.0, path=False), BAND)
    np.testing.assert_array_equal(terms.transmission(np.array([0.0, 1e5])), 1.0)


def test_aerosol_of_rural_air_and_of_fog():
    assert aerosol_per_km(23.0) == pytest.approx(0.0153, abs=1e-4)
    assert aerosol_per_km(0.5) == pytest.approx(2.1, abs=0.05)
    assert aerosol_per_km(0.2) == pytest.approx(23.5, abs=0.1)


def test_an_unknown_band_is_refused_and_the_known_ones_named():
    with pytest.raises(InputError, match=r"3-5 um; choose one of 8-14 and 7\.5-13\.5 um"):
        band((3.0, 5.0))


def test_smooth_dielectrics_have_an_index_per_band():
    from scenegen.materials.table import material

    water = material("water_fresh_or_sea")
    assert mirror_index(water, (8.0, 14.0)).n == pytest.approx(1.2388)
    assert mirror_index(water, (7.5, 13.5)).k == pytest.approx(0.1312)
    assert mirror_index(material("asphalt_aged"), (8.0, 14.0)) is None
