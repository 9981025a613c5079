"""What must hold for the arrays of every frame: each rule has teeth, when they are read and when they are written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.encode import encode_frame
from scenegen_datasets.invariants import violations
from scenegen_datasets.layers import LAYERS


def arrays(fakes: ModuleType) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(3)
    frame, reading = fakes.frame(rng, extra=True), fakes.reading(rng)
    pictures = {n: getattr(frame, n).copy() for n in LAYERS if n not in ("thermal", "imu")}
    return pictures | {"thermal": reading.counts, "imu": fakes.imu(3)}


def put(name: str, at: tuple[int, ...], value: float) -> Callable[[dict[str, np.ndarray]], None]:
    def change(layers: dict[str, np.ndarray]) -> None:
        layers[name][at] = value

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (put("thermal", (5, 5), 16384), "counts above 16383"),
        (put("depth", (5, 5), 0.0), "depth: not positive"),
        (put("depth", (5, 5), -1.0), "depth: not positive"),
        (put("depth", (5, 5), np.nan), "depth: not positive"),
        (put("depth", (5, 5), np.inf), "exactly in the sky"),
        (put("depth", (0, 5), 10.0), "exactly in the sky"),
        (put("radiance", (5, 5), np.nan), "radiance"),
        (put("radiance", (5, 5), np.inf), "radiance"),
        (put("radiance", (5, 5), 0.0), "radiance"),
        (put("temperature", (5, 5), np.nan), "temperature"),
        (put("temperature", (5, 5), -3.0), "temperature"),
        (put("temperature", (5, 5), 0.0), "temperature: 0 K"),
        (put("temperature", (0, 5), 280.0), "temperature: 0 K"),
        (put("semantic", (5, 5), 99), "class id 99"),
        (put("material", (5, 5), 0), "no material"),
        (put("material", (5, 5), 900), "material id 900"),
        (put("instance", (0, 5), 7), "sky has an instance"),
        (put("flow", (0, 0, 0), np.inf), "flow: infinite"),
        (put("flow_back", (0, 0, 1), -np.inf), "flow_back: infinite"),
        (put("flow", (5, 5, 0), 12.0), "outside the other image"),
        (put("flow", (5, 5, 1), np.nan), "outside the other image"),
        (put("normal", (5, 5, 2), 3.0), "unit length"),
        (put("imu", (4, 2), np.nan), "imu: not finite"),
        (put("imu", (4, 0), 0.0), "imu: time does not rise"),
    ],
)
def test_each_invariant_has_teeth(
    fakes: ModuleType, change: Callable[[dict[str, np.ndarray]], None], reason: str
) -> None:
    layers = arrays(fakes)
    layers["covisible"][5, 5] = layers["covisible_back"][5, 5] = True
    assert violations(layers) == []
    change(layers)
    assert reason in "; ".join(violations(layers))


def test_nothing_forbidden_is_ever_encoded(fakes: ModuleType) -> None:
    rng = np.random.default_rng(0)
    frame, reading = fakes.frame(rng), fakes.reading(rng)
    bad = frame.radiance.copy()
    bad[6, 6] = np.nan
    with pytest.raises(DatasetError, match="k-0: radiance"):
        encode_frame("k-0", replace(frame, radiance=bad), reading, fakes.meta(0))
    with pytest.raises(DatasetError, match="flow_back, normal asked for but not rendered"):
        encode_frame("k-0", frame, reading, fakes.meta(0), ("thermal", "flow_back", "normal"))
    with pytest.raises(DatasetError, match="one pixel grid"):
        encode_frame("k-0", frame, fakes.reading(rng, (3, 3)), fakes.meta(0))
    with pytest.raises(InputError, match="perhaps you meant 'depth'"):
        encode_frame("k-0", frame, reading, fakes.meta(0), ("deph",))
