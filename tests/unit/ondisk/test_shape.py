"""A shape lets through what has it, names the one place that has not, and never raises, whatever it is given."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenegen_datasets.documents import CLIP, DESCRIPTION, HISTORY, LOCK, PARTS, RECEIPT
from scenegen_datasets.shape import Each, Maybe, Numbers, Text, Whole, mapping, misshapen

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4),
    max_leaves=12,
)
SHAPE: dict[str, Any] = {
    "size": Whole(-3, 9),
    "name": Text(r"[a-z]+", 5),
    "pose": Numbers(2, 2),
    "depth": Maybe(Numbers()),
    "sums": Each(Text(r"[0-9]"), ("a",)),
    "frames": [{"key": Text(), "more": mapping}],
}
WORD = st.text("abc", min_size=1, max_size=5)
NUMBER = st.integers(-(10**6), 10**6) | st.floats(-1e300, 1e300)
SOUND = st.fixed_dictionaries(
    {
        "size": st.integers(-3, 9),
        "name": WORD,
        "pose": st.lists(st.lists(NUMBER, min_size=2, max_size=2), min_size=2, max_size=2),
        "depth": st.none() | NUMBER,
        "sums": st.dictionaries(WORD, st.sampled_from("059")).map(lambda d: {**d, "a": "1"}),
        "frames": st.lists(
            st.fixed_dictionaries({"key": st.text(max_size=9), "more": st.dictionaries(WORD, JSON)}),
            max_size=3,
        ),
    }
)


@given(SOUND, st.dictionaries(st.text(min_size=6, max_size=9), JSON, max_size=2))
@settings(max_examples=60, deadline=None)
def test_what_has_the_shape_passes_with_names_beyond_it(value: dict[str, Any], more: dict[str, Any]) -> None:
    assert misshapen(more | value, SHAPE) is None


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every place in a document, as keys from its root."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, child in inner for place in places(child, (*path, key)))]


@given(SOUND, JSON, st.data())
@settings(max_examples=200, deadline=None)
def test_one_wrong_value_is_named_by_its_place(
    value: dict[str, Any], wrong: Any, data: st.DataObject
) -> None:
    checked = [p for p in places(value)[1:] if p[0] != "frames" or len(p) < 3 or p[2] != "more"]
    place = data.draw(st.sampled_from(checked))
    changed = copy.deepcopy(value)
    owner = changed
    for key in place[:-1]:
        owner = owner[key]
    assume(type(wrong) is not type(owner[place[-1]]) and not isinstance(wrong, int | float))
    assume(not (place == ("depth",) and wrong is None))
    owner[place[-1]] = wrong
    said = misshapen(changed, SHAPE)
    assert said is not None and said.startswith(str(place[0]))


@pytest.mark.parametrize("name", SHAPE)
def test_a_missing_name_is_named(name: str) -> None:
    value = {
        "size": 1,
        "name": "a",
        "pose": [[0, 1], [2, 3]],
        "depth": None,
        "sums": {"a": "1"},
        "frames": [],
    }
    assert misshapen(value, SHAPE) is None
    value.pop(name)
    assert misshapen(value, SHAPE) == f"{name} is missing"


@pytest.mark.parametrize("shape", [RECEIPT, DESCRIPTION, LOCK, HISTORY, CLIP, PARTS])
@given(value=JSON)
@settings(max_examples=40, deadline=None)
def test_no_document_makes_a_check_raise(shape: Any, value: Any) -> None:
    """Nor does one that begins well: every mapping of the shape gets the value in turn."""
    assert misshapen(value, shape) is None or isinstance(misshapen(value, shape), str)
    if isinstance(shape, dict):
        for name in shape:
            assert misshapen(dict.fromkeys(shape, value) | {name: None}, shape) is not None


@pytest.mark.parametrize(
    ("value", "rule"),
    [
        (True, Whole(0, 9)),
        (1.0, Whole(0, 9)),
        (10, Whole(0, 9)),
        ("5", Whole(0, 9)),
        (True, Numbers()),
        (10**400, Numbers()),
        (float("inf"), Numbers()),
        (float("nan"), Numbers()),
        ([1, [2]], Numbers(2)),
        ([1, 2, 3], Numbers(2)),
        ([[1, 2], [3]], Numbers(2, 2)),
        ((1, 2), Numbers(2)),
        ("ab\n", Text(r"[a-z]+")),
        ("x" * 4097, Text()),
        (b"a", Text()),
        ([], mapping),
    ],
)
def test_each_rule_refuses(value: Any, rule: Any) -> None:
    assert misshapen(value, rule) is not None


def test_a_name_of_a_stranger_is_cut_in_the_message() -> None:
    said = misshapen({"x" * 10**6: 1}, Each(Text()))
    assert said is not None and len(said) < 200


def test_the_shape_of_a_lock_is_that_of_a_sound_one(pristine: Any) -> None:
    """The shapes above are not so narrow that they refuse what is written."""
    for name, shape in (("recipe.lock.json", LOCK), ("dataset.json", DESCRIPTION)):
        assert misshapen(json.loads((pristine / name).read_bytes()), shape) is None
