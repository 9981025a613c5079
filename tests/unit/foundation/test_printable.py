"""What strangers wrote can be shown: nothing of it reaches the terminal as a command."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation.printable import printable, printable_json, printable_lines

ANY_TEXT = st.text(st.characters(exclude_categories=()))
"""Halves of surrogate pairs among it: a file name may hold any byte."""


@given(ANY_TEXT)
@settings(max_examples=200, deadline=None)
def test_whatever_it_was_one_line_is_left_that_can_be_encoded(text: str) -> None:
    shown = printable(text)
    assert shown.isprintable() and shown.encode().decode() == shown
    assert shown == text or not text.isprintable()


@given(ANY_TEXT)
@settings(max_examples=100, deadline=None)
def test_lines_stay_lines(text: str) -> None:
    assert printable_lines(text).split("\n") == [printable(line) for line in text.split("\n")]


@given(st.recursive(ANY_TEXT | st.integers(), lambda inner: st.dictionaries(ANY_TEXT, inner), max_leaves=8))
@settings(max_examples=200, deadline=None)
def test_json_reads_back_to_the_same(value: object) -> None:
    shown = printable_json(json.dumps(value, indent=2, ensure_ascii=False))
    assert json.loads(shown) == value
    assert all(line.isprintable() for line in shown.split("\n"))


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Zürich, 3 µm: 20 °C", "Zürich, 3 µm: 20 °C"),
        ("\x1b[2J", "\\x1b[2J"),
        ("\x9b2J", "\\x9b2J"),
        ("a\tb\r\n", "a\\tb\\r\\n"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
        ("\udcff", "\\udcff"),
        ("\U000e0041", "\\U000e0041"),
    ],
)
def test_examples(text: str, shown: str) -> None:
    assert printable(text) == shown


def test_the_command_line_prints_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    from scenegen_cli.console import complain, note, say, say_json

    evil = "\x1b]0;x\x07\u202e\udcff\x9b2J"
    for show in (say, note, complain):
        show(f"one {evil}\ntwo")
    say_json({evil: [evil]})
    shown = capsys.readouterr()
    assert all(line.isprintable() for line in (shown.out + shown.err).split("\n"))
    assert shown.out.startswith("one \\x1b]0;x\\x07\\u202e\\udcff\\x9b2J\ntwo\n")
    assert json.loads(shown.out.partition("two\n")[2]) == {evil: [evil]}
