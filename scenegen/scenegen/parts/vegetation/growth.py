"""What a growth model hands over: wood order by order, and foliage, for a tree of about unit height."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.parts.vegetation.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Plan:
    """How richly a tree is modelled, and how it stands in the season.

    Attributes
    ----------
    faces : int
        Triangles it may take, about.
    in_leaf : float
        Share of the foliage it carries, 0..1.
    """

    faces: int
    in_leaf: float


@dataclass(frozen=True, eq=False)
class Grown:
    """One tree.

    Attributes
    ----------
    trunk : Mesh
    limbs : Mesh
        Thick wood.
    twigs : Mesh
        Thin wood, which takes the temperature of the air sooner.
    leaves : Mesh
    """

    trunk: Mesh
    limbs: Mesh
    twigs: Mesh
    leaves: Mesh
