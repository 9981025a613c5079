"""A whole page as one file."""

from __future__ import annotations

from scenegen_datasets.pages.markup import Html, text
from scenegen_datasets.pages.sheet import SHEET


def document(title: str, *content: Html, sheet: str = "", script: str = "") -> str:
    """Put a page together.

    Parameters
    ----------
    title : str
        Of the window.
    *content : Html
        What stands in it.
    sheet, script : str
        Style and script of this page alone.
    """
    run = f"<script>{script}</script>" if script else ""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f"<title>{text(title)}</title><style>{SHEET}{sheet}</style></head><body><main>"
        f"{''.join(content)}</main>{run}</body></html>\n"
    )
