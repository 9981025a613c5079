"""Flags: a command's own, and any recipe key."""

from typing import Any

import pytest

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted, size
from scenegen_cli.console import span, table
from scenegen_cli.parse import parse, parse_size, split_recipe_flags
from scenegen_cli.render import Render

KEYS = ["seed", "map", "layers", "camera.width_px"]


@pytest.mark.parametrize(
    ("words", "rest", "values"),
    [
        (["--pairs", "8"], ["--pairs", "8"], {}),
        (["--seed", "3", "--pairs", "8"], ["--pairs", "8"], {"seed": 3}),
        (["--pairs", "8", "--seed=3"], ["--pairs", "8"], {"seed": 3}),
        (["--map", "city", "--map", "field"], [], {"map": ["city", "field"]}),
        (["--map", "city", "field"], [], {"map": ["city", "field"]}),
        (["--camera.width-px", "640"], [], {"camera": {"width_px": 640}}),
        (["--climate.hour", "20", "23.5"], [], {"climate": {"hour": [20, 23.5]}}),
        (["--climate.hour", "[20, 23]"], [], {"climate": {"hour": [20, 23]}}),
        (["--flight.pitch-deg", "-20", "-5"], [], {"flight": {"pitch_deg": [-20, -5]}}),
        (["--sensor.noise", "false"], [], {"sensor": {"noise": False}}),
        (["--sensor.noise", "no"], [], {"sensor": {"noise": "no"}}),
        (["--climate.date", "07-15"], [], {"climate": {"date": "07-15"}}),
        (["--climate.date", "null"], [], {"climate": {"date": None}}),
        (["--a.b", "1", "--a.c", "2"], [], {"a": {"b": 1, "c": 2}}),
    ],
)
def test_recipe_keys_are_taken_out_of_the_command_line(
    words: list[str], rest: list[str], values: dict[str, Any]
) -> None:
    assert split_recipe_flags(words, KEYS) == (rest, values)


@pytest.mark.parametrize(
    "words",
    [["--seed"], ["--camera.width-px", "--seed", "3"], ["--a.b", "1", "--a.b.c", "2"], ["--a.b", "*x"]],
)
def test_flags_without_a_usable_value_are_refused(words: list[str]) -> None:
    with pytest.raises(InputError):
        split_recipe_flags(words, KEYS)


def test_a_commands_flags_are_its_dataclass() -> None:
    command = parse(Render, "render", ["--pairs", "8", "--dry-run", "--no-verify"])
    assert (command.pairs, command.dry_run, command.no_verify, command.out) == (8, True, True, None)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--pears", "8"], "unknown flag '--pears'; perhaps you meant '--pairs'"),
        (["--pairs", "x"], "--pairs: 'x' is not a whole number"),
        (["--pairs"], "--pairs: a value is missing"),
        (["more"], "'more' is one word too many"),
    ],
)
def test_mistakes_come_out_as_one_line(words: list[str], message: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(Render, "render", words)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_sizes() -> None:
    assert parse_size("640x512") == parse_size("640 X 512") == (640, 512)
    for wrong in ("640", "x", "640x", "-1x5", "1.5x2", "640x512x3", ""):
        with pytest.raises(InputError):
            parse_size(wrong)


def test_words_for_people() -> None:
    assert [size(n) for n in (0, 999, 1500, 2.5e9, 7e12)] == ["0 B", "999 B", "1.5 kB", "2.5 GB", "7.0 TB"]
    assert [span(s) for s in (0.2, 59, 187, 3753)] == ["0 s", "59 s", "3:07", "1:02:33"]
    assert table([("a", "bb"), ("ccc", "d")]) == "a    bb\nccc  d"


def test_numbers_in_sentences() -> None:
    assert [counted(n, "clip") for n in (0, 1, 1234)] == ["0 clips", "1 clip", "1,234 clips"]
    assert counted(2, "process") == "2 processes"
