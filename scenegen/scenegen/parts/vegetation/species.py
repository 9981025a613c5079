"""The species: what a tree of each kind looks like, as data for the growth models.

Lengths are shares of the tree's height unless they say otherwise. Outlines and branching follow the descriptions of
free-standing trees in field guides (e.g. Mitchell 1974, "A Field Guide to the Trees of Britain and Northern Europe");
leaf-out order from common phenological calendars: birch and poplar a week before, oak a week after the average.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from scenegen.parts.vegetation.habits import Broadleaf, Feather, Leaves, Outline, Whorled, Wood


@dataclass(frozen=True)
class Species:
    """One kind of tree.

    Attributes
    ----------
    name : str
    growth : Broadleaf, Whorled or Feather
    evergreen : bool
    shift_d : float
        Leaf-out against the average deciduous tree [d].
    """

    name: str
    growth: Broadleaf | Whorled | Feather
    evergreen: bool = False
    shift_d: float = 0.0


_ALL = (
    Species(
        "oak",
        Broadleaf(
            Outline(base=0.20, widest=0.42, roundness=2.3, radius=0.46),
            Wood(1, 0.034, 0.52, 13, 6, 5, (82.0, 18.0), 48.0, 0.25, 0.15, 0.30),
            Leaves(cover=4.0, slender=1.5, droop=0.15, clumped=0.45),
        ),
        shift_d=7.0,
    ),
    Species(
        "lime",
        Broadleaf(
            Outline(base=0.17, widest=0.36, roundness=1.9, radius=0.34),
            Wood(1, 0.024, 0.78, 17, 6, 4, (72.0, 20.0), 45.0, 0.35, -0.10, 0.14),
            Leaves(cover=4.0, slender=1.25, droop=0.35, clumped=0.25),
        ),
    ),
    Species(
        "maple",
        Broadleaf(
            Outline(base=0.19, widest=0.48, roundness=2.2, radius=0.38),
            Wood(1, 0.026, 0.62, 14, 6, 4, (62.0, 15.0), 42.0, 0.30, 0.20, 0.17),
            Leaves(cover=4.1, slender=1.1, droop=0.20, clumped=0.3),
        ),
        shift_d=-2.0,
    ),
    Species(
        "birch",
        Broadleaf(
            Outline(base=0.18, widest=0.34, roundness=1.6, radius=0.24),
            Wood(1, 0.014, 0.94, 20, 5, 4, (52.0, 26.0), 40.0, 0.10, -0.85, 0.12),
            Leaves(cover=3.2, slender=1.9, droop=0.75, clumped=0.15),
        ),
        shift_d=-8.0,
    ),
    Species(
        "poplar",
        Broadleaf(
            Outline(base=0.07, widest=0.40, roundness=2.0, radius=0.125),
            Wood(1, 0.019, 0.96, 26, 5, 3, (30.0, 14.0), 24.0, 0.45, 0.45, 0.08),
            Leaves(cover=3.9, slender=1.4, droop=0.1, clumped=0.15),
        ),
        shift_d=-5.0,
    ),
    Species(
        "spruce", Whorled(Outline(0.05, 0.04, 1.12, 0.21), 0.017, 20, 7, (-14.0, 42.0), 0.30, 1.25),
        evergreen=True,
    ),
    Species(
        "fir", Whorled(Outline(0.04, 0.06, 1.35, 0.18), 0.016, 21, 7, (2.0, 46.0), 0.12, 0.9), evergreen=True,
    ),
    Species(
        "pine",
        Broadleaf(
            Outline(base=0.44, widest=0.52, roundness=2.1, radius=0.29),
            Wood(1, 0.020, 0.86, 13, 5, 3, (88.0, 35.0), 50.0, 0.25, 0.45, 0.26),
            Leaves(cover=5.0, slender=1.5, droop=-0.3, clumped=0.7),
        ),
        evergreen=True,
    ),
    Species(
        "cypress",
        Broadleaf(
            Outline(base=0.03, widest=0.33, roundness=1.8, radius=0.085),
            Wood(1, 0.014, 0.97, 26, 4, 2, (25.0, 12.0), 22.0, 0.45, 0.45, 0.05),
            Leaves(cover=10.0, slender=2.0, droop=0.1, clumped=0.1),
        ),
        evergreen=True,
    ),
    Species(
        "olive",
        Broadleaf(
            Outline(base=0.22, widest=0.45, roundness=2.2, radius=0.50),
            Wood(2, 0.042, 0.58, 14, 6, 4, (78.0, 12.0), 48.0, 0.25, -0.05, 0.30),
            Leaves(cover=3.8, slender=1.3, droop=0.15, clumped=0.1),
        ),
        evergreen=True,
    ),
    Species("palm", Feather(Outline(0.6, 0.5, 2.0, 0.30), 0.021, 30, 15, 0.12), evergreen=True),
)  # fmt: skip

SPECIES: Mapping[str, Species] = MappingProxyType({s.name: s for s in _ALL})
"""All species by name."""
