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


def table(columns: Sequence[Column | str], rows: Iterable[Sequence[object]], *, dense: bool = False) -> Html:
    """A table that scrolls sideways where it does not fit; cells are escaped unless they are markup.

    Parameters
    ----------
    columns : sequence of Column or str
        Without a word in any of them the table has no head.
    rows : iterable of sequence
    dense : bool
        Smaller letters, for a table of many columns.
    """
    heads = [column if isinstance(column, Column) else Column(column) for column in columns]
    top = "".join(_head(head) for head in heads) if any(head.words for head in heads) else ""
    above = f"<thead><tr>{top}</tr></thead>" if top else ""
    kind = ' class="dense"' if dense else ""
    body = "".join(
        "<tr>"
        + "".join(f"<td{_kind(h)}>{text(cell)}</td>" for h, cell in zip(heads, row, strict=True))
        + "</tr>"
        for row in rows
    )
    return Html(f'<div class="scroll"><table{kind}>{above}<tbody>{body}</tbody></table></div>')


def _head(column: Column) -> str:
    """A head says whose it is; a column of bars needs none."""
    if not column.words:
        return f"<td{_kind(column)}></td>"
    return f'<th scope="col"{_kind(column)}>{text(column.words)}</th>'


def _kind(column: Column) -> str:
    return f' class="{text(column.kind)}"' if column.kind else ""
