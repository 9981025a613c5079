"""Layers as pictures for the page, each with the words that say what its colours mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from jaxtyping import Float, UInt8
from numpy.typing import NDArray

from scenegen.classes import CLASSES
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.ramp import STOPS, Ramp, depth_ramp, ramp_of
from scenegen_datasets.pictures.scales import MAX_GAIN
from scenegen_datasets.view.library import Still
from scenegen_render.sensor.agc import percentile_agc, plateau_agc

Gain = Literal["plateau", "linear", "clip"]
Palette = Literal["white hot", "black hot", "inferno"]

GAINS: Mapping[Gain, str] = {
    "plateau": "plateau equalisation, as cameras show video",
    "linear": "linear, 0.5 to 99.5 % of the frame",
    "clip": "linear, one range for the whole clip",
}
"""Gain controls of the thermal picture."""

_KEY = 8
PALETTES: tuple[Palette, ...] = ("white hot", "black hot", "inferno")


@dataclass(frozen=True)
class Ranges:
    """What the ends of the colours stand for: the same for all frames of a clip, so that scrubbing does not flicker.

    Attributes
    ----------
    thermal_K, temperature_K : (float, float)
        Brightness and kinetic temperature at both ends [K].
    depth_m : (float, float)
        Distance at both ends of the logarithmic scale [m].
    flow_px : float
        Length at full colour [px].
    """

    thermal_K: tuple[float, float]
    temperature_K: tuple[float, float]
    depth_m: tuple[float, float]
    flow_px: float

    @classmethod
    def of(cls, stills: list[Still]) -> Ranges:
        """Ranges that show these frames well."""
        flows = [s.layers["flow"] for s in stills if "flow" in s.layers]
        kinetic = [s.layers["temperature"] for s in stills if "temperature" in s.layers]
        return cls(
            _span([s.brightness_K for s in stills]),
            _span([t[t > 0] for t in kinetic]),
            colour.depth_range([s.layers["depth"] for s in stills]),
            colour.flow_range(flows) if flows else 1.0,
        )


@dataclass(frozen=True, eq=False)
class Panel:
    """A picture and what its colours mean.

    Attributes
    ----------
    picture : uint8 (rows, columns, 3)
    caption : str
    ramp : Ramp, optional
        Of values on one axis.
    key : tuple of ((red, green, blue), str)
        Of names, the commonest in the picture first.
    """

    picture: UInt8[np.ndarray, "rows columns 3"]
    caption: str
    ramp: Ramp | None = None
    key: tuple[tuple[tuple[int, ...], str], ...] = ()


def panel(still: Still, layer: str, ranges: Ranges, gain: Gain, palette: Palette) -> Panel:
    """Draw one layer of a frame.

    Parameters
    ----------
    still : Still
    layer : str
        One of `drawable(still.layers)`.
    ranges : Ranges
        Of the clip.
    gain, palette
        Of the thermal picture.
    """
    if layer == "thermal":
        return _thermal(still, ranges, gain, palette)
    return _DRAWN[layer](still.layers[layer], ranges)


def drawable(layers: tuple[str, ...]) -> tuple[str, ...]:
    """Those of the stored layers that can be drawn."""
    return tuple(name for name in layers if name == "thermal" or name in _DRAWN)


def _thermal(still: Still, ranges: Ranges, gain: Gain, palette: Palette) -> Panel:
    if gain == "plateau":
        grey = plateau_agc(still.counts, max_gain=MAX_GAIN)
        low, high = _span([still.brightness_K])
    elif gain == "linear":
        grey = percentile_agc(still.counts)
        low, high = _span([still.brightness_K])
    else:
        low, high = ranges.thermal_K
        grey = _stretched(still.brightness_K, low, high)
    kelvin, first = np.unique(still.brightness_K, return_index=True)
    levels = np.interp(np.linspace(low, high, STOPS), kelvin, grey.ravel()[first].astype(np.float64))
    bar = _toned(np.rint(levels)[None].astype(np.uint8), palette)[0]
    return Panel(_toned(grey, palette), GAINS[gain], ramp_of(f"{low:.1f} K", f"{high:.1f} K", bar))


def _toned(grey: UInt8[np.ndarray, "rows columns"], palette: Palette) -> UInt8[np.ndarray, "rows columns 3"]:
    if palette == "inferno":
        return np.asarray(cv2.applyColorMap(grey, cv2.COLORMAP_INFERNO)[..., ::-1], np.uint8)
    return np.repeat((255 - grey if palette == "black hot" else grey)[..., None], 3, axis=2)


def _depth(values: NDArray[Any], ranges: Ranges) -> Panel:
    low, high = ranges.depth_m
    return Panel(colour.depth(values, low, high), "logarithmic; sky blue-grey", depth_ramp((low, high)))


def _temperature(values: NDArray[Any], ranges: Ranges) -> Panel:
    low, high = ranges.temperature_K
    picture = np.asarray(cv2.applyColorMap(_stretched(values, low, high), cv2.COLORMAP_INFERNO)[..., ::-1])
    picture = np.where((values > 0)[..., None], picture, np.array(colour.SKY_COLOUR, np.uint8))
    return Panel(
        picture,
        "kinetic, one range for the clip; sky blue-grey",
        ramp_of(f"{low:.1f} K", f"{high:.1f} K", _bar("inferno")),
    )


def _radiance(values: NDArray[Any], ranges: Ranges) -> Panel:
    low, high = (float(x) for x in np.percentile(values, (0.5, 99.5)))
    grey = _stretched(values, low, high)
    ends = f"{low:.2f}", f"{high:.2f} W m⁻² sr⁻¹"
    return Panel(_toned(grey, "white hot"), "noise-free", ramp_of(*ends, _bar("white hot")))


def _flow(values: NDArray[Any], ranges: Ranges) -> Panel:
    return Panel(
        colour.flow(values, ranges.flow_px), f"hue is direction; full colour is {ranges.flow_px:g} px a frame"
    )


def _ids(values: NDArray[Any], ranges: Ranges) -> Panel:
    return Panel(colour.instance(values.astype(np.uint32)), "one colour an id; 0 blue-grey")


def _semantic(values: NDArray[Any], ranges: Ranges) -> Panel:
    counts = np.bincount(values.ravel(), minlength=len(CLASSES))
    common = [k for k in np.argsort(-counts, kind="stable").tolist() if counts[k]][:_KEY]
    key = tuple(
        (tuple(CLASSES[k].colour) if k else colour.SKY_COLOUR, CLASSES[k].name.replace("_", " "))
        for k in common
    )
    return Panel(colour.semantic(values), "the commonest classes of the frame", key=key)


def _mask(values: NDArray[Any], ranges: Ranges) -> Panel:
    return Panel(
        _toned(np.where(values, 255, 0).astype(np.uint8), "white hot"),
        "white where the other frame sees it too",
    )


def _normal(values: NDArray[Any], ranges: Ranges) -> Panel:
    picture = np.rint(np.clip(values * 0.5 + 0.5, 0.0, 1.0) * 255.0).astype(np.uint8)
    return Panel(picture, "x, y, z of the camera frame as red, green, blue")


_DRAWN: Mapping[str, Callable[[NDArray[Any], Ranges], Panel]] = {
    "depth": _depth,
    "flow": _flow,
    "flow_back": _flow,
    "radiance": _radiance,
    "temperature": _temperature,
    "semantic": _semantic,
    "instance": _ids,
    "material": _ids,
    "covisible": _mask,
    "covisible_back": _mask,
    "normal": _normal,
}


def _bar(palette: Palette) -> UInt8[np.ndarray, "colours 3"]:
    greys = np.linspace(0, 255, STOPS).round().astype(np.uint8)
    return np.asarray(_toned(greys[None], palette)[0])


def _stretched(
    values: Float[np.ndarray, "rows columns"], low: float, high: float
) -> UInt8[np.ndarray, "rows columns"]:
    share = (values - np.float32(low)) / np.float32(max(high - low, 1e-9))
    return np.asarray(np.rint(np.clip(share, 0.0, 1.0) * 255.0), np.uint8)


def _span(values: list[NDArray[Any]]) -> tuple[float, float]:
    """0.5th and 99.5th percentile of all values together; something harmless where there are none."""
    every = np.concatenate([v.ravel() for v in values]) if values else np.zeros(0)
    if every.size == 0:
        return 273.15, 303.15
    low, high = np.percentile(every, (0.5, 99.5))
    return float(low), float(high)
