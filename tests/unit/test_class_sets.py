"""Every class has a name elsewhere, and the documented table is the code's."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from scenegen.class_sets import AIRSIM, CITYSCAPES, CITYSCAPES_LABELS, cityscapes_table
from scenegen.classes import CLASSES, Semantic

_DOC = Path(__file__).parents[2] / "docs" / "classes.md"
_ROW = re.compile(
    r"^\| (\d+) \| `(\w+)` \| (thing|stuff) \| `(#\w{6})` \| ([\w ]+) \((\d+)\) \| (\w+) \|$", re.M
)


def test_every_class_is_mapped_once() -> None:
    assert set(CITYSCAPES) == set(AIRSIM) == set(Semantic)
    assert set(CITYSCAPES.values()) == set(CITYSCAPES_LABELS)


def test_the_table_translates_arrays() -> None:
    ids = np.array([[Semantic.SKY, Semantic.ROAD], [Semantic.TREE, Semantic.WINDOW]], np.uint8)
    assert cityscapes_table()[ids].tolist() == [[23, 7], [21, 11]]


def test_the_document_lists_what_the_code_says() -> None:
    rows = [m.groups() for m in _ROW.finditer(_DOC.read_text(encoding="utf-8"))]
    expected = [
        (
            str(int(c.id)),
            c.name,
            "thing" if c.thing else "stuff",
            "#{:02x}{:02x}{:02x}".format(*c.colour),
            CITYSCAPES[c.id],
            str(CITYSCAPES_LABELS[CITYSCAPES[c.id]]),
            AIRSIM[c.id],
        )
        for c in CLASSES
    ]
    assert rows == expected
