"""From what was asked (preset, file, flags) to one validated model, and from its errors to one line each.

Sources are nested mappings of plain data. Later sources win key by key. An error names the source that set the key:
``recipe.yaml: camera.netdmk: unknown key; perhaps you meant 'netd_mk'``.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from scenegen.foundation.errors import InputError, nearest

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True)
class Source:
    """Where some keys come from.

    Attributes
    ----------
    name : str
        File name, or "" for the command line, whose keys are shown as ``--a.b``.
    values : mapping
        Nested plain data.
    """

    name: str
    values: Mapping[str, Any]


def resolve(model: type[Model], sources: Sequence[Source]) -> Model:
    """Merge the sources and validate the result.

    Parameters
    ----------
    model : type
        A pydantic model that refuses unknown keys.
    sources : sequence of Source
        From weakest to strongest.

    Raises
    ------
    InputError
        For the first thing that is wrong, in one line.
    """
    try:
        return model.model_validate(merge(source.values for source in sources))
    except ValidationError as error:
        details = error.errors(include_url=False)
        # An unknown key is most likely the cause of whatever else is wrong.
        first = min(details, key=lambda d: d["type"] != "extra_forbidden")
        more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
        raise InputError(_line(first, model, sources) + more) from None


def merge(layers: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Later mappings win key by key; mappings are merged, everything else is replaced."""
    merged: dict[str, Any] = {}
    for layer in layers:
        for key, value in layer.items():
            below = merged.get(key)
            if isinstance(value, Mapping):
                merged[key] = merge([below if isinstance(below, Mapping) else {}, value])
            else:
                merged[key] = value
    return merged


def leaves(model: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, str, Any]]:
    """All keys of a model: dotted name, one-line meaning, default."""
    for name, field in model.model_fields.items():
        section = section_of(model, name)
        if section is not None:
            yield from leaves(section, f"{prefix}{name}.")
        else:
            default = field.get_default(call_default_factory=True)
            yield f"{prefix}{name}", " ".join((field.description or "").split()), default


def section_of(model: type[BaseModel], key: str) -> type[BaseModel] | None:
    """The nested model behind a key, or None if the key holds a value."""
    field = model.model_fields.get(key)
    kind = field.annotation if field is not None else None
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def unknown(model: type[BaseModel], keys: Sequence[str]) -> str:
    """The nearest right thing for the unknown dotted key `keys`; "" if it is known."""
    here: type[BaseModel] | None = model
    for depth, key in enumerate(keys):
        if here is None or key not in here.model_fields:
            return _suggest(model, here, keys[: depth + 1])
        here = section_of(here, key)
    return ""


def _suggest(model: type[BaseModel], here: type[BaseModel] | None, keys: Sequence[str]) -> str:
    word = keys[-1]
    siblings = list(here.model_fields) if here is not None else []
    if difflib.get_close_matches(word, siblings, n=1, cutoff=0.6):
        return nearest(word, siblings)
    everywhere = {name.rsplit(".", 1)[-1]: name for name, _, _ in leaves(model)}
    close = difflib.get_close_matches(word, list(everywhere), n=1, cutoff=0.8)
    return f"; perhaps you meant '{everywhere[close[0]]}'" if close else nearest(word, siblings)


def _line(detail: ErrorDetails, model: type[BaseModel], sources: Sequence[Source]) -> str:
    path = [part for part in detail["loc"] if isinstance(part, str)]
    keys = _real_keys(model, path) if detail["type"] != "extra_forbidden" else path
    what = f"unknown key{unknown(model, keys)}" if detail["type"] == "extra_forbidden" else _what(detail)
    return f"{_where(keys, sources)}: {what}" if keys else what


def _real_keys(model: type[BaseModel], path: Sequence[str]) -> list[str]:
    """Cut what pydantic adds below a field (union members, tuple items)."""
    keys: list[str] = []
    here: type[BaseModel] | None = model
    for part in path:
        if here is None or part not in here.model_fields:
            break
        keys.append(part)
        here = section_of(here, part)
    return keys


def _where(keys: Sequence[str], sources: Sequence[Source]) -> str:
    dotted = ".".join(keys)
    for source in reversed(sources):
        if _holds(source.values, keys):
            return f"{source.name}: {dotted}" if source.name else f"--{dotted}"
    return dotted


def _holds(values: Any, keys: Sequence[str]) -> bool:
    for key in keys:
        if not isinstance(values, Mapping) or key not in values:
            return False
        values = values[key]
    return True


def _what(detail: ErrorDetails) -> str:
    kind, given = detail["type"], detail.get("input")
    shown = repr(given) if not isinstance(given, Mapping | list | tuple) else "several values"
    shown = shown if len(shown) <= 60 else f"{shown[:57]}..."
    if kind == "value_error":
        return " ".join(str(detail["ctx"]["error"]).split())
    if kind == "missing":
        return "is missing"
    if kind in ("model_type", "model_attributes_type"):
        return f"has keys of its own, {shown} is not a mapping"
    if kind == "literal_error" and isinstance(given, str):
        known = [word.strip("' ") for word in str(detail["ctx"]["expected"]).replace(" or ", ",").split(",")]
        return f"unknown value '{given}'{nearest(given, known)}"
    message = (
        detail["msg"]
        .replace("Input should be", "must be")
        .replace("valid integer", "whole number")
        .replace("valid tuple", "list")
        .replace("valid ", "")
    )
    return f"{message}, not {shown}" if given is not None else f"{message}, not empty"
