"""One value, one byte sequence, one digest; and no input that hurts before it is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@given(PLAIN)
@settings(max_examples=100, deadline=None)
def test_plain_data_survives_and_is_the_same_again(value: Any) -> None:
    try:
        data = canonical.canonical(value)
    except UnicodeEncodeError:  # lone surrogates are not text
        return
    back = canonical.parse(data, "x")
    assert back == value
    assert canonical.canonical(back) == data
    assert json.loads(canonical.pretty(value)) == value


def test_order_of_keys_and_tuples_do_not_matter() -> None:
    assert canonical.digest({"b": (1, 2), "a": 0.5}) == canonical.digest({"a": 0.5, "b": [1, 2]})
    assert canonical.canonical({"b": [1, 2.5], "a": "ä"}) == '{"a":"ä","b":[1,2.5]}'.encode()
    assert canonical.digest({}) == "44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a"


@pytest.mark.parametrize("value", [math.nan, math.inf, {"a": [-math.inf]}])
def test_what_is_not_a_number_is_refused(value: Any) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        canonical.canonical(value)


@pytest.mark.parametrize("value", [{1: 2}, {"a": {True: 1}}, [{None: 1}], {"a": object()}, {"a": {1, 2}}])
def test_what_is_not_plain_data_is_refused(value: Any) -> None:
    with pytest.raises(TypeError):
        canonical.canonical(value)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b'{"a": 1, "a": 2}',
        b'[{"b": {"c": 0, "\\u0063": 0}}]',
        b"nan",
        b"NaN",
        b"[Infinity]",
        b"{'a': 1}",
        b"\xff\xfe",
        b'{"a": 1} x',
        b"[" * 100_000,
        b"[" * 80 + b"]" * 80,
    ],
)
def test_bad_input_is_one_clear_error(data: bytes) -> None:
    with pytest.raises(DatasetError, match="somewhere"):
        canonical.parse(data, "somewhere")


def test_size_is_checked_before_reading(tmp_path: Path) -> None:
    path = tmp_path / "big.json"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(DatasetError, match="more than the 1000"):
        canonical.read(path, max_bytes=1000)
    with pytest.raises(DatasetError, match="missing"):
        canonical.read(tmp_path / "none.json")
