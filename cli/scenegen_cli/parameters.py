"""What a command takes, read off its dataclass: arguments and flags, as help and complaints name them."""

from __future__ import annotations

import ast
import inspect
from dataclasses import MISSING, Field, dataclass, fields
from itertools import pairwise
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import tyro

_KINDS = {int: "N", float: "X", str: "TEXT", Path: "PATH"}


@dataclass(frozen=True)
class Parameter:
    """One argument or flag of a command.

    Attributes
    ----------
    label : str
        ``DATASET``, ``[MAP]``, ``PART ...``, ``--json``, ``--jobs N``.
    meaning : str
        The docstring under its field, on one line.
    default : str
        As a user would write it; "" for none.
    positional : bool
        An argument, not a flag.
    required : bool
        It must be given.
    several : bool
        It takes all words that follow.
    """

    label: str
    meaning: str
    default: str
    positional: bool
    required: bool
    several: bool

    @property
    def flag(self) -> str:
        """Its name on the command line, without what follows: ``--jobs``."""
        return self.label.partition(" ")[0]


def parameters(command: type) -> list[Parameter]:
    """What a command takes, in the order of its fields.

    Parameters
    ----------
    command : type
        Frozen dataclass with a docstring under every field, as tyro reads it.
    """
    meanings, kinds = _docstrings(command), get_type_hints(command, include_extras=True)
    return [_parameter(field, kinds[field.name], meanings[field.name]) for field in fields(command)]


def in_words(value: Any) -> str:
    """A default as a user would write it; "" for none."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return " ".join(map(in_words, value))
    if isinstance(value, float):
        return f"{value:g}"
    return str(value) if value or value == 0 else ""


def _parameter(field: Field[Any], annotated: Any, meaning: str) -> Parameter:
    marks = getattr(annotated, "__metadata__", ())
    kind = get_args(annotated)[0] if marks else annotated
    positional, required = tyro.conf.Positional in marks, field.default is MISSING
    several = (
        get_origin(kind) is tuple and Ellipsis in get_args(kind) and tyro.conf.UseAppendAction not in marks
    )
    if positional:
        label = f"{field.name.upper().removesuffix('S')} ..." if several else field.name.upper()
        label = label if required else f"[{label}]"
    else:
        label = _flag(field, kind) + (" ..." if several else "")
    default = "" if required or kind is bool else in_words(field.default)
    return Parameter(label, meaning, default, positional, required, several)


def _flag(field: Field[Any], kind: Any) -> str:
    name = field.name.replace("_", "-")
    if kind is bool:
        return f"--no-{name}" if field.default is True else f"--{name}"
    return f"--{name} {_value(kind)}"


def _value(kind: Any) -> str:
    """What is written behind a flag."""
    members = [member for member in get_args(kind) if member not in (type(None), Ellipsis)]
    if get_origin(kind) is Literal:
        return "{" + ",".join(members) + "}"
    if get_origin(kind) in (Union, UnionType, tuple):
        return " ".join(_KINDS[member] for member in members)
    return _KINDS[kind]


def _docstrings(command: type) -> dict[str, str]:
    """The string under each field, inherited ones included, on one line."""
    found = {}
    for owner in command.__mro__[:-1]:
        (written,) = ast.parse(inspect.getsource(owner)).body
        assert isinstance(written, ast.ClassDef)
        for above, below in pairwise(written.body):
            if isinstance(above, ast.AnnAssign) and isinstance(above.target, ast.Name):
                assert isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant), above.target.id
                found[above.target.id] = " ".join(str(below.value.value).split())
    return found
