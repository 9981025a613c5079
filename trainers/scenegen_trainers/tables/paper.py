"""Table 1 of the paper: its rows, its figures, and the order relations its text claims.

Its figures cannot be met digit by digit: AirSim's scenes, the authors' settings and even the unit of RMSE are unknown.
What can be asked is whether the same relations hold.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from scenegen_trainers.evaluation.scores import NAMES


@dataclass(frozen=True)
class Row:
    """A row of Table 1.

    Attributes
    ----------
    key : str
        Directory name.
    method : str
    model : str
        Of `scenegen_trainers.training.recipe.MODELS`.
    w_l1 : float
    published : tuple of float
        RMSE, Rel, delta_1, delta_2, delta_3.
    """

    key: str
    method: str
    model: str
    w_l1: float
    published: tuple[float, float, float, float, float]

    @property
    def figures(self) -> Mapping[str, float]:
        """Published figures by name."""
        return dict(zip(NAMES, self.published, strict=True))


ROWS = (
    Row("conventional-100", "Pix2Pix", "pix2pix", 100.0, (7.083, 0.536, 0.702, 0.820, 0.893)),
    Row("proposed-0", "proposed", "pix2pix-flow", 0.0, (7.118, 0.548, 0.669, 0.783, 0.867)),
    Row("proposed-100", "proposed", "pix2pix-flow", 100.0, (7.064, 0.516, 0.708, 0.831, 0.901)),
    Row("proposed-200", "proposed", "pix2pix-flow", 200.0, (6.986, 0.528, 0.710, 0.832, 0.901)),
    Row("proposed-300", "proposed", "pix2pix-flow", 300.0, (6.906, 0.418, 0.720, 0.832, 0.908)),
)
"""All five, in the paper's order."""


@dataclass(frozen=True)
class Relation:
    """Some rows are better than others.

    Attributes
    ----------
    claim : str
    better, worse : tuple of str
        Keys of rows; each of the first is to be better than each of the second.
    """

    claim: str
    better: tuple[str, ...]
    worse: tuple[str, ...]


_OTHERS = ("conventional-100", "proposed-100", "proposed-200")

RELATIONS = (
    Relation("w_L1 = 0 is worst", (*_OTHERS, "proposed-300"), ("proposed-0",)),
    Relation("w_L1 = 300 is best", ("proposed-300",), (*_OTHERS, "proposed-0")),
    Relation("flow helps at w_L1 = 100", ("proposed-100",), ("conventional-100",)),
)
"""What the paper's own figures support. They are not monotonic in w_L1 (Rel at 200), so no more is asked."""
