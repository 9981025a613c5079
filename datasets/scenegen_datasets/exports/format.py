"""What an export format is: a description for people, and two functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage


@dataclass(frozen=True)
class Written:
    """What came of one clip.

    Attributes
    ----------
    counts : mapping of str to int
        How many values did not fit, by what became of them; names are those of `Format.invalid`.
    facts : mapping
        Plain data for `Format.finish`.
    """

    counts: Mapping[str, int] = field(default_factory=dict)
    facts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Exported:
    """One clip that is there, as `Format.finish` sees it.

    Attributes
    ----------
    name, map, split : str
        Of the clip.
    world, clip, frames : int
    facts : mapping
        Of `Written`.
    """

    name: str
    map: str
    split: str
    world: int
    clip: int
    frames: int
    facts: Mapping[str, Any]


Finish = Callable[[Stage, Sequence[Exported], Mapping[str, Any], Options], None]
"""Writes what belongs to the whole export (lists, splits, cameras): stage, clips in plan order, ``dataset.json``,
options."""


def nothing_to_finish(
    stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options
) -> None:
    """For formats whose clips stand alone."""


@dataclass(frozen=True)
class Format:
    """One format of somebody else.

    Attributes
    ----------
    name : str
        What ``--to`` takes.
    readers, layout, range, step, lost, sky : str
        One line each for people; together a row of the table in ``docs/exports.md``.
    needs : tuple of str
        Layers it cannot do without.
    takes : tuple of str
        Layers it writes if the dataset holds them.
    pairs_only : bool
        Whether it leaves out frame 0 of each clip, which is no pair.
    one_camera : bool
        Whether it has room for the intrinsics of one camera only; parts of a merged dataset may differ in theirs.
    bytes_per_pixel : float
        Size of a frame on disk, on the high side; measured on city flights.
    write : callable
        Writes one clip below a `Stage`. What it writes depends on nothing but the clip and the options.
    finish : callable
        `Finish`, called once with all clips in plan order, when all of them are there.
    heeds : frozenset of str
        Fields of `Options` that matter to it.
    invalid : mapping of str to str
        What the counts of `Written` mean, in words that follow a number.
    extra : str
        Optional dependency it needs, empty for none.
    modules : tuple of str
        What that extra must make importable.
    """

    name: str
    readers: str
    layout: str
    range: str
    step: str
    lost: str
    sky: str
    needs: tuple[str, ...]
    bytes_per_pixel: float
    write: Callable[[Clip, Stage, Options], Written]
    pairs_only: bool = False
    one_camera: bool = False
    takes: tuple[str, ...] = ()
    finish: Finish = nothing_to_finish
    heeds: frozenset[str] = frozenset()
    invalid: Mapping[str, str] = field(default_factory=dict)
    extra: str = ""
    modules: tuple[str, ...] = ()

    def row(self) -> tuple[str, ...]:
        """Cells of its row in the table of formats."""
        return (self.name, self.readers, self.layout, self.range, self.step, self.lost, self.sky)
