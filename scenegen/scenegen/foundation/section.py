"""A section of a recipe: the one place where a key, its default, its bounds and its meaning stand."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from scenegen.foundation.words import counted


class Section(BaseModel):
    """Base of all recipe sections: frozen, unknown keys refused, no NaN or infinity anywhere."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)


def _no_bool(value: Any) -> Any:
    if isinstance(value, bool | str):
        raise ValueError(f"expected a number, not {value!r}")
    return value


Number = Annotated[float, BeforeValidator(_no_bool)]
"""A finite real number; ``true`` is not 1 and ``"300"`` is not 300."""

Count = Annotated[int, BeforeValidator(_no_bool), Field(strict=True)]
"""A whole number; ``true`` is not 1 and ``3.0`` is not 3."""


def _span(value: Any) -> Any:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value)
    if isinstance(value, list | tuple) and len(value) == 2:
        return tuple(value)
    given = counted(len(value), "value") if isinstance(value, list | tuple) else f"{value!r:.60}"
    raise ValueError(f"expected a number, or two for a range, not {given}")


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(
            f"the range [{value[0]:g}, {value[1]:g}] is upside down; write the smaller number first"
        )
    return value


Span = Annotated[tuple[Number, Number], BeforeValidator(_span), AfterValidator(_ordered)]
"""A closed range to draw from, ``[low, high]``; a single number means that very value."""


def within(low: float, high: float) -> AfterValidator:
    """Bounds for a `Span`: ``Annotated[Span, within(0.0, 1.0)]``."""

    def check(value: tuple[float, float]) -> tuple[float, float]:
        if not low <= value[0] <= value[1] <= high:
            raise ValueError(f"[{value[0]:g}, {value[1]:g}] lies outside {low:g} to {high:g}")
        return value

    return AfterValidator(check)


Share = Annotated[Span, within(0.0, 1.0)]
"""A range of shares between 0 and 1."""
