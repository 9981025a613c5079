"""What describes how a plant grows: outlines, branching, foliage, and one record for each way of growing."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Outline:
    """Outline of a crown, a solid of revolution.

    Attributes
    ----------
    base : float
        Height of its lower end.
    widest : float
        Where between base (0) and top (1) it is widest.
    roundness : float
        Exponent of its two halves: 1 is a double cone, 2 an ellipse, larger is boxier.
    radius : float
        Largest half-width.
    """

    base: float
    widest: float
    roundness: float
    radius: float


@dataclass(frozen=True)
class Wood:
    """How it branches.

    Attributes
    ----------
    stems : int
        Trunks that rise from the ground.
    girth : float
        Radius of the trunk above its flare.
    leader : float
        Height the trunk reaches as a trunk: apical dominance, 1 for conifers and poplars, 0.5 for oaks.
    limbs, branches, twigs : int
        Limbs of a tree of some 2,500 triangles, branches of each limb, twigs of each branch.
    limb_angle_deg : (float, float)
        Between trunk and limb, for the lowest and the highest limb.
    branch_angle_deg : float
        Between a branch and what it grows from.
    upturn : float
        How much limbs turn towards the sky over their length; negative droops.
    twig_upturn : float
        The same for branches and twigs.
    crooked : float
        Random turn of a limb from one node to the next [rad].
    """

    stems: int
    girth: float
    leader: float
    limbs: int
    branches: int
    twigs: int
    limb_angle_deg: tuple[float, float]
    branch_angle_deg: float
    upturn: float
    twig_upturn: float
    crooked: float


@dataclass(frozen=True)
class Leaves:
    """Foliage: cards that stand for sprays of leaves.

    Attributes
    ----------
    cover : float
        Area of all cards over the area of the crown's outline seen from the side; decides how much sky shines through.
    slender : float
        Length over width of a card.
    droop : float
        How far cards hang, 0 along the twig, 1 down.
    clumped : float
        How tightly cards keep to the ends of branches, 0 spread along them, 1 in tufts.
    """

    cover: float
    slender: float
    droop: float
    clumped: float


@dataclass(frozen=True)
class Broadleaf:
    """Branches order by order inside an outline; also pines and cypresses, which grow that way when free-standing."""

    outline: Outline
    wood: Wood
    leaves: Leaves


@dataclass(frozen=True)
class Whorled:
    """A conifer: a straight trunk and whorls of drooping boughs with hanging sprays.

    Attributes
    ----------
    outline : Outline
    girth : float
    whorls, boughs : int
        Whorls of a large tree; boughs of each.
    rise_deg : (float, float)
        Elevation of the lowest and the highest boughs where they leave the trunk.
    sag : float
        How far a bough bends down over its length; its tip turns up again.
    curtain : float
        How far the sprays hang below their bough, in distances between whorls.
    """

    outline: Outline
    girth: float
    whorls: int
    boughs: int
    rise_deg: tuple[float, float]
    sag: float
    curtain: float


@dataclass(frozen=True)
class Feather:
    """A palm with feather fronds.

    Attributes
    ----------
    outline : Outline
        Only its radius counts: how far fronds reach.
    girth : float
    fronds, leaflets : int
        Fronds of a crown; leaflets on each side of a large one.
    lean : float
        How far the trunk leans and curves.
    """

    outline: Outline
    girth: float
    fronds: int
    leaflets: int
    lean: float
