"""What a user may choose about an export. Each format says which of these it heeds; the others keep their defaults."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from scenegen.foundation.errors import InputError, nearest

GAINS = ("clip", "ground", "fixed")
"""How counts become eight bits, see `scenegen_datasets.exports.gain`."""

ENCODINGS = ("counts", "a65c")
"""What sixteen bits of thermal mean: our counts, or those of the camera that recorded MS2."""


LEAST_M, MOST_M = 1e-6, 1e6
"""Lengths that make sense as a step or as a cap of depth."""


@dataclass(frozen=True)
class Options:
    """Choices that change what an export holds; they are part of its identity.

    Attributes
    ----------
    gain : str
        One of `GAINS`.
    gain_K : (float, float)
        Brightness temperatures [K] of black and white with ``gain="fixed"``.
    depth_cap_m : float
        Depth [m] that is white where depth becomes an 8-bit picture.
    depth_unit_m : float
        What one step of a 16-bit depth picture is worth [m], where a format leaves that open.
    encoding : str
        One of `ENCODINGS`.

    Raises
    ------
    InputError
        If a value cannot be used.
    """

    gain: str = "clip"
    gain_K: tuple[float, float] = (233.0, 343.0)
    depth_cap_m: float = 100.0
    depth_unit_m: float = 1.0 / 5000.0
    encoding: str = "counts"

    def __post_init__(self) -> None:
        for name, known in (("gain", GAINS), ("encoding", ENCODINGS)):
            if getattr(self, name) not in known:
                raise InputError(
                    f"--{name} {getattr(self, name)}: unknown{nearest(getattr(self, name), known)}"
                )
        low, high = self.gain_K
        if not (0.0 < low < high < math.inf):
            raise InputError(
                f"--gain-K {low:g} {high:g}: give two temperatures in kelvin, the lower one first"
            )
        for name in ("depth_cap_m", "depth_unit_m"):
            if not LEAST_M <= getattr(self, name) <= MOST_M:
                raise InputError(
                    f"--{name.replace('_', '-')} {getattr(self, name):g}: give a length of {LEAST_M:g} to {MOST_M:g} m"
                )

    def heeded(self, names: Collection[str], by: str) -> dict[str, Any]:
        """The choices a format heeds, as plain data.

        Raises
        ------
        InputError
            If another choice was made, since it would change nothing.
        """
        for field in fields(self):
            if field.name not in names and getattr(self, field.name) != field.default:
                raise InputError(
                    f"--{field.name.replace('_', '-')} changes nothing in an export to {by}; leave it away"
                )
        values = {name: value for name, value in asdict(self).items() if name in names}
        if values.get("gain", "fixed") != "fixed":
            values.pop("gain_K", None)
        return {name: list(v) if isinstance(v, tuple) else v for name, v in values.items()}


def options_from(values: Mapping[str, Any]) -> Options:
    """Read what `Options.heeded` returned."""
    plain: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in values.items()}
    return Options(**plain)
