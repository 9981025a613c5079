"""What a recipe file may contain, what it means, and what is refused in one line with a line number."""

import math
import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation.errors import InputError
from scenegen.foundation.strict_yaml import parse_mapping, read_mapping, scalar

BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{chr(98 + i)}: &{chr(98 + i)} [{', '.join(['*' + chr(97 + i)] * 9)}]\n" for i in range(9)
)

SCALARS = [
    ("1", 1),
    ("-5", -5),
    ("+1", 1),
    ("0", 0),
    ("1e3", 1000.0),
    ("1.5", 1.5),
    (".5", 0.5),
    ("1.", 1.0),
    ("-2.5E-3", -0.0025),
    ("true", True),
    ("False", False),
    ("null", None),
    ("~", None),
    ("", None),
    ("no", "no"),
    ("on", "on"),
    ("Yes", "Yes"),
    ("017", "017"),
    ("0x1F", "0x1F"),
    ("0o17", "0o17"),
    ("1_000", "1_000"),
    ("12:30:45", "12:30:45"),
    ("2021-07-15", "2021-07-15"),
    ("e3", "e3"),
    ("1e", "1e"),
    (".", "."),
    ("-", "-"),
]

REFUSED = [
    ("a: 1\na: 2", ":2: duplicate key 'a'"),
    ("a:\n  b: 1\n  b: 2", ":3: duplicate key 'b'"),
    ("a: &x 1\nb: *x", ":1: anchor '&x'"),
    ("b: *x", ":1: alias '*x'"),
    (BOMB, ":1: anchor '&a'"),
    ("a: !!python/object/apply:os.system [x]", ":1: tag"),
    ("a: !!str 1", ":1: tag"),
    ("a: !mine 1", ":1: tag"),
    ("!!map {a: 1}", ":1: anchors and tags"),
    ("- 1\n- 2", ":1: a recipe is a mapping"),
    ("5", ":1: a recipe is a mapping"),
    ("just words", ":1: a recipe is a mapping"),
    ("", "is empty"),
    ("# only a comment", "is empty"),
    ("a: 1\n---\nb: 2", ":2: a second document"),
    ("a: [1", "is not YAML"),
    ("a: b: c", ":1: is not YAML"),
    ("a: @x", ":1: is not YAML"),
    ("a:\n\tb: 1", ":2: is not YAML"),
    ("a: \x01", "is not YAML"),
    ("a: " + "[" * 40 + "]" * 40, ":1: nested deeper than 32"),
    ("a: " + "[" * 5000, ":1: nested deeper than 32"),
    ("a: " + "9" * 30, ":1: a number of 30 digits"),
    ("a: [" + "1," * 30_000 + "]", "more than 20000 values"),
    ("{a: 1}: 2", ":1: a key is plain text"),
    ("[a]: 2", ":1: a key is plain text"),
    ("1: 2", ":1: key '1'"),
    ("null: 2", ":1: key 'null'"),
    ("true: 2", ":1: key 'true'"),
    ("a: '" + "x" * (1 << 20) + "'", "larger than 1 MiB"),
    (b"\xff\xfea: 1", "not UTF-8"),
    (b"a: \xc3\x28", "not UTF-8"),
    ("a: '\ud800'", "not UTF-8"),
]


@pytest.mark.parametrize(("text", "value"), SCALARS)
def test_scalar(text: str, value: object) -> None:
    assert scalar(text) == value
    assert type(scalar(text)) is type(value)


def test_infinities_are_read_so_that_the_recipe_can_refuse_them_by_key() -> None:
    assert scalar("-.inf") == -math.inf
    assert scalar("1e999") == math.inf
    assert math.isnan(scalar(".nan"))


@pytest.mark.parametrize(("text", "message"), REFUSED, ids=lambda v: repr(v)[:30])
def test_refused_in_one_line(text: str | bytes, message: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_mapping(text, "recipe.yaml")
    assert str(caught.value).startswith("recipe.yaml:")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


def test_accepted() -> None:
    text = "seed: 1\nclimate: {hour: [6, 18.5]}\nname: '017'\nlist:\n  - on\n  - null\n<<: plain\n"
    assert parse_mapping("\ufeff" + text, "x") == {
        "seed": 1,
        "climate": {"hour": [6, 18.5]},
        "name": "017",
        "list": ["on", None],
        "<<": "plain",
    }


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=80) | st.text(alphabet="ab:-[]{}&*!'\"\n\t #,?|>%@0.e1~", max_size=60))
def test_any_bytes_give_a_mapping_or_one_line(content: bytes | str) -> None:
    try:
        assert isinstance(parse_mapping(content, "f"), dict)
    except InputError as error:
        assert "\n" not in str(error)


def test_unreadable_paths(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, message in [
        (tmp_path, "is a directory"),
        (tmp_path / "nowhere.yaml", "does not exist"),
        (tmp_path / "pipe", "is no file"),
    ]:
        with pytest.raises(InputError, match=message) as raised:
            read_mapping(path)
        assert str(raised.value).startswith(f"{path}: {message}")


def test_reads_a_file(tmp_path: Path) -> None:
    (tmp_path / "r.yaml").write_text("seed: 3\n", encoding="utf-8")
    assert read_mapping(tmp_path / "r.yaml") == {"seed": 3}
