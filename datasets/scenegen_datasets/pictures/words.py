"""Time, place and weather in the words that stand above pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


def clock(hour: float) -> str:
    """Such as ``05:12``."""
    minutes = int(hour * 60.0) % 1440
    return f"{minutes // 60:02d}:{minutes % 60:02d}"


def time_of_day(hour: float) -> str:
    """Local mean solar time, such as ``05:12 solar time``."""
    return f"{clock(hour)} solar time"


def date(month: int, day: int) -> str:
    """Such as ``15 Jul``."""
    return f"{day} {_MONTHS[month - 1]}"


def latitude(degrees: float) -> str:
    """Such as ``48°N``; the equator has no side."""
    whole = round(degrees)
    return f"{abs(whole)}°{'N' if whole > 0 else 'S' if whole else ''}"


def sky(cloud_fraction: float) -> str:
    """Clear, so many eighths, or overcast."""
    if cloud_fraction < 0.15:
        return "clear"
    return "overcast" if cloud_fraction > 0.9 else f"{round(8 * cloud_fraction)}/8 cloud"


def wind(speed_mps: float) -> str:
    """Such as ``wind 3.1 m/s``."""
    return f"wind {speed_mps:.1f} m/s"


def celsius(kelvin: float) -> str:
    """Such as ``12 °C``."""
    return f"{round(kelvin - 273.15)} °C"


def clip_words(facts: Mapping[str, Any]) -> str:
    """Hour, date, place and weather of a clip, as the loader gives them under ``facts``, in one line."""
    return "   ".join(
        (
            time_of_day(float(facts["hour"])),
            date(int(facts["month"]), int(facts["day"])),
            latitude(float(facts["latitude_deg"])),
            f"sun {float(facts['sun_elevation_deg']):+.0f}°",
            sky(float(facts["cloud_fraction"])),
            wind(float(facts["wind_mps"])),
            f"mean air {celsius(float(facts['air_mean_K']))}",
            f"flying {float(facts['speed_mps']):.0f} m/s",
        )
    )
