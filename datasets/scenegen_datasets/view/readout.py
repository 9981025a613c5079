"""The numbers under the cursor."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from scenegen.classes import CLASSES
from scenegen_datasets.view.library import Still

_CLASS_NAMES = {int(row.id): row.name for row in CLASSES}


def readout(still: Still, column: int, row: int, materials: Mapping[int, str]) -> dict[str, str]:
    """What is known about one pixel, by name, in the units of the dataset.

    Parameters
    ----------
    still : Still
    column, row : int
        Of the pixel, from the upper left.
    materials : mapping
        Names of material ids.

    Raises
    ------
    IndexError
        Outside the picture.
    """
    rows, columns = still.counts.shape
    if not (0 <= column < columns and 0 <= row < rows):
        raise IndexError(f"pixel ({column}, {row}) of a picture of {columns} x {rows}")
    at = (row, column)
    found = {
        "pixel": f"({column}, {row})",
        "thermal": f"{int(still.counts[at])} counts",
        "brightness": f"{float(still.brightness_K[at]):.2f} K",
        "measured": f"{float(still.measured[at]):.3f} W m⁻² sr⁻¹",
    }
    layers = still.layers
    depth = float(layers["depth"][at])
    found["depth"] = f"{depth:.3f} m" if np.isfinite(depth) else "sky"
    if "radiance" in layers:
        found["noise-free"] = f"{float(layers['radiance'][at]):.3f} W m⁻² sr⁻¹"
    if "temperature" in layers:
        kinetic = float(layers["temperature"][at])
        found["kinetic"] = f"{kinetic:.2f} K" if kinetic > 0 else "sky"
    if "semantic" in layers:
        number = int(layers["semantic"][at])
        found["class"] = _CLASS_NAMES.get(number, str(number))
    if "instance" in layers:
        found["object"] = str(int(layers["instance"][at]))
    if "material" in layers:
        number = int(layers["material"][at])
        found["material"] = materials.get(number, str(number) if number else "sky")
    if "flow" in layers:
        u, v = (float(x) for x in layers["flow"][at])
        found["flow"] = f"({u:+.2f}, {v:+.2f}) px"
    return found
