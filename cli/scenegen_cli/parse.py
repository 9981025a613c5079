"""Flags: a command's own are a frozen dataclass read by tyro; those of recipe keys are read like YAML values.

Whatever is wrong with them comes out as one line.
"""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, TypeVar

import tyro

from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.strict_yaml import parse_mapping
from scenegen_cli.console import say
from scenegen_cli.helping import command_help
from scenegen_cli.leaving import HelpShown
from scenegen_cli.parameters import Parameter, parameters

Command = TypeVar("Command")

_FRAME = re.compile(r"[│╭╮╰╯|+]")
_RULE = re.compile(r"[─-]{9,}")
_IN_OUR_WORDS = (
    (re.compile(r"no type matching .+ Got errors: .+<class '\w+'>: "), ""),
    (re.compile(r"invalid literal for int\(\) with base 10: (.+)"), r"\1 is not a whole number"),
    (re.compile(r"could not convert string to float: (.+)"), r"\1 is not a number"),
    (re.compile(r"Missing value for argument '(.+?)'\. Expected 1 values\."), r"\1: a value is missing"),
    (re.compile(r"Could not find valid parse for arguments: \[(.+)\]"), r"\1 cannot be read"),
)


def parse(command: type[Command], name: str, arguments: Sequence[str], more_help: str = "") -> Command:
    """Read a command's flags.

    Parameters
    ----------
    command : type
        Frozen dataclass; its docstrings are the help.
    name : str
        Of the subcommand.
    arguments : sequence of str
    more_help : str
        Printed below the help.

    Raises
    ------
    InputError
        For an unknown flag (naming the nearest) or an unusable value.
    HelpShown
        After ``--help``.
    """
    if any(word in ("-h", "--help") for word in arguments):
        say(command_help(command, name) + more_help)
        raise HelpShown
    takes = parameters(command)
    _refuse_unknown(arguments, takes)
    _refuse_empty(arguments, takes)
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            value, rest = tyro.cli(
                command,
                prog=f"scenegen {name}",
                args=list(arguments),
                return_unknown_args=True,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
    except SystemExit:
        text = _one_line(complaint.getvalue())
        raise InputError(f"{_missing(text, takes) or text} (see 'scenegen {name} --help')") from None
    if rest:
        raise InputError(_unknown(rest[0], _flags(takes)))
    return value


def split_recipe_flags(arguments: Sequence[str], keys: Sequence[str]) -> tuple[list[str], dict[str, Any]]:
    """Take the recipe keys out of a command line.

    A flag that names a recipe key, or contains a dot, takes all words up to the next flag: one word is that value,
    several are a list. Words mean what they would mean in YAML. A flag given twice adds to the list.

    Parameters
    ----------
    arguments : sequence of str
    keys : sequence of str
        Dotted names of all recipe keys.

    Returns
    -------
    rest : list of str
        What was not a recipe key.
    values : dict
        Nested plain data.
    """
    rest: list[str] = []
    values: dict[str, list[Any]] = {}
    words = list(arguments)
    while words:
        word = words.pop(0)
        name, equals, inline = word[2:].partition("=")
        key = name.replace("-", "_")
        if not word.startswith("--") or not ("." in key or key in keys):
            rest.append(word)
            continue
        given = [inline] if equals else []
        while not equals and words and not words[0].startswith("--"):
            given.append(words.pop(0))
        if not given:
            raise InputError(f"{word}: a value is missing")
        values.setdefault(key, []).extend(_value(word, text) for text in given)
    return rest, _nested(values)


def parse_size(text: str) -> tuple[int, int]:
    """``256x192`` as (256, 192).

    Raises
    ------
    InputError
        If it is nothing like that.
    """
    match = re.fullmatch(r"([0-9]{1,9})\s*[xX×]\s*([0-9]{1,9})", text.strip())
    if match is None:
        raise InputError(f"--size {text}: write WIDTHxHEIGHT, such as 640x512")
    return int(match[1]), int(match[2])


def _value(flag: str, text: str) -> Any:
    name = flag.partition("=")[0]
    try:
        return parse_mapping(f"value: {text}", name)["value"]
    except InputError:
        raise InputError(f"{name}: '{text}' is not a value") from None


def _nested(values: dict[str, list[Any]]) -> dict[str, Any]:
    nested: dict[str, Any] = {}
    for dotted, given in values.items():
        *path, last = dotted.split(".")
        here = nested
        for part in path:
            here = here.setdefault(part, {})
            if not isinstance(here, dict):
                raise InputError(f"--{dotted}: '{part}' is given a value of its own as well")
        here[last] = given[0] if len(given) == 1 else given
    return nested


def _unknown(word: str, known: Sequence[str]) -> str:
    if not word.startswith("-"):
        return f"'{word}' is one word too many"
    return f"unknown flag '{word}'{nearest(word, known)}"


def _flags(takes: Sequence[Parameter]) -> list[str]:
    return [one.flag for one in takes if not one.positional]


def _refuse_unknown(arguments: Sequence[str], takes: Sequence[Parameter]) -> None:
    """Before tyro takes the word behind a misspelt flag for that flag's value, and misses an argument."""
    known = _flags(takes)
    for word in arguments:
        name = word.partition("=")[0].replace("_", "-")
        if word.startswith("--") and name not in known:
            raise InputError(_unknown(word, known))


def _refuse_empty(arguments: Sequence[str], takes: Sequence[Parameter]) -> None:
    """A flag that takes all words up to the next flag takes at least one."""
    greedy = {one.flag for one in takes if one.several and not one.positional}
    for word, after in pairwise([*arguments, "--"]):
        if word in greedy and after.startswith("--"):
            raise InputError(f"{word}: a value is missing")


def _missing(complaint: str, takes: Sequence[Parameter]) -> str:
    """Name the first required thing whose meaning a complaint repeats, as tyro does if it is missing."""
    for one in takes:
        if one.required and one.meaning in complaint:
            return f"{one.label} is missing: {one.meaning.rstrip('.')}"
    return ""


def _one_line(box: str) -> str:
    """The message of tyro's box, without the box, in words of ours where tyro's are Python's."""
    lines = [_FRAME.sub(" ", line).strip() for line in box.splitlines()]
    title = next((k for k, line in enumerate(lines) if line), 0)
    said: list[str] = []
    for line in lines[title + 1 :]:
        if _RULE.search(line) and said:
            break
        if not _RULE.search(line):
            said.append(line)
    text = " ".join(" ".join(said).split())
    for pattern, ours in _IN_OUR_WORDS:
        text = pattern.sub(ours, text)
    return text.removeprefix("Error parsing ") or "the command line cannot be read"
