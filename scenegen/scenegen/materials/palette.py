"""The palette of a world: a few variants of each material it uses, drawn inside the measured ranges.

The heat balance is solved once per variant and orientation class, so the number of variants bounds its cost.
"""

from __future__ import annotations

import numpy as np

from scenegen.materials.material import Build, Material, Surface
from scenegen.materials.table import material

MAX_VARIANTS = 4
"""Drawn variants of one material in one world, at most."""

MAX_SPECIALS = 4
"""Variants with properties of their own besides (paint, a pond, a bonnet over an engine), at most. They count apart,
because what is warm must not depend on which subsystem drew its variants first."""

ABSORPTANCE_SPREAD = 0.06
"""Half-width of the spread of solar absorptance around the table's value: soiling, age, colour."""

HEATED_ROOM_K = (292.0, 297.0)
"""Air temperature [K] of heated rooms, 19-24 degrees Celsius."""

_HEATED = frozenset({Build.WALL_INSULATED, Build.ROOF_INSULATED, Build.ROOF_VENTILATED, Build.WINDOW})


class PaletteBuilder:
    """Collects the surfaces of one world while it is built.

    Parameters
    ----------
    rng : numpy.random.Generator
        Draws the variants, in the order in which materials are first asked for.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._surfaces: list[Surface] = []
        self._variants: dict[str, tuple[int, ...]] = {}

    def variants(self, name: str, count: int = MAX_VARIANTS) -> tuple[int, ...]:
        """Palette indices of the variants of a material; drawn when first asked for.

        Parameters
        ----------
        name : str
            Material name.
        count : int
            Number of variants to draw, 1 to `MAX_VARIANTS`; ignored once the material has been drawn.

        Raises
        ------
        InputError
            If there is no such material.
        """
        if name not in self._variants:
            assert 1 <= count <= MAX_VARIANTS
            row = material(name)
            self._variants[name] = tuple(self._append(_draw(row, self._rng)) for _ in range(count))
        return self._variants[name]

    def pick(self, name: str, rng: np.random.Generator) -> int:
        """One variant of a material, at random."""
        options = self.variants(name)
        return options[int(rng.integers(len(options)))]

    def only(self, name: str) -> int:
        """The one variant of a material of which the world needs no more."""
        return self.variants(name, 1)[0]

    def special(
        self,
        name: str,
        key: str,
        solar_absorptance: float | None = None,
        interior_K: float = float("nan"),
        prescribed_K: float = float("nan"),
        released_Wm2: float = 0.0,
    ) -> int:
        """Add a variant with properties of its own (paint on asphalt, a bonnet over a hot engine), once per key.

        At most `MAX_SPECIALS` per material; what was made first under a key stays.
        """
        entry = f"{name}/{key}"
        if entry not in self._variants:
            drawn = _draw(material(name), self._rng)
            self._variants[entry] = (
                self._append(
                    Surface(
                        material=drawn.material,
                        emissivity=drawn.emissivity,
                        solar_absorptance=drawn.solar_absorptance
                        if solar_absorptance is None
                        else solar_absorptance,
                        interior_K=interior_K if np.isfinite(interior_K) else drawn.interior_K,
                        prescribed_K=prescribed_K,
                        released_Wm2=released_Wm2,
                    )
                ),
            )
            assert sum(key.startswith(f"{name}/") for key in self._variants) <= MAX_SPECIALS
        return self._variants[entry][0]

    def surfaces(self) -> tuple[Surface, ...]:
        """The palette so far, in index order."""
        return tuple(self._surfaces)

    def _append(self, surface: Surface) -> int:
        self._surfaces.append(surface)
        return len(self._surfaces) - 1


def _draw(row: Material, rng: np.random.Generator) -> Surface:
    """One variant inside the measured ranges; the same number of draws whatever the material."""
    emissivity = float(rng.uniform(*row.emissivity_range))
    shift = float(rng.uniform(-ABSORPTANCE_SPREAD, ABSORPTANCE_SPREAD))
    room_K = float(rng.uniform(*HEATED_ROOM_K))
    return Surface(
        material=row,
        emissivity=emissivity,
        solar_absorptance=float(np.clip(row.solar_absorptance + shift, 0.02, 0.98)),
        interior_K=room_K if row.build in _HEATED else float("nan"),
    )
