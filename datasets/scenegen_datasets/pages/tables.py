"""Tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from scenegen_datasets.pages.markup import Html, text


@dataclass(frozen=True)
class Column:
    """Head of a column.

    Attributes
    ----------
    words : str
    kind : str
        Class of its cells: ``number`` stands to the right, ``wide`` takes space, ``name`` never breaks, ``big``.
    """

    words: str
    kind: str = ""


def number(words: str) -> Column:
    """A column of numbers."""
    return Column(words, "number")


def table(columns: Sequence[Column | str], rows: Iterable[Sequence[object]]) -> Html:
    """A table that scrolls sideways where it does not fit; cells are escaped unless they are markup."""
    heads = [column if isinstance(column, Column) else Column(column) for column in columns]
    top = "".join(f"<th{_kind(head)}>{text(head.words)}</th>" for head in heads)
    body = "".join(
        "<tr>"
        + "".join(f"<td{_kind(h)}>{text(cell)}</td>" for h, cell in zip(heads, row, strict=True))
        + "</tr>"
        for row in rows
    )
    return Html(
        f'<div class="scroll"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'
    )


def _kind(column: Column) -> str:
    return f' class="{text(column.kind)}"' if column.kind else ""
