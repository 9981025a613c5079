"""Text that is safe in a page, and the pieces every page is put together from."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape


class Html(str):
    """Markup: what is of this type goes into a page as it is, everything else is escaped on the way."""

    __slots__ = ()


def text(words: object) -> Html:
    """Words safe between tags and in attributes; markup stays as it is."""
    return words if isinstance(words, Html) else Html(escape(str(words), quote=True))


def join(parts: Iterable[object], between: str = "") -> Html:
    """Several pieces as one."""
    return Html(between.join(text(part) for part in parts))


def element(tag: str, *content: object, **attributes: object) -> Html:
    """An element with attributes; a trailing underscore of a name is dropped (``class_``), None leaves one out."""
    words = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{text(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return Html(f"<{tag}{words}>{join(content)}</{tag}>")


def picture(data: bytes, kind: str, words: str, width: int, height: int, **attributes: object) -> Html:
    """A picture inside the page.

    Parameters
    ----------
    data : bytes
    kind : str
        Subtype, such as ``webp``.
    words : str
        What it shows, for those who cannot see it.
    width, height : int
        [px], so that nothing jumps while the page loads.
    **attributes
        Further ones.
    """
    source = f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"
    given = {"src": source, "alt": words, "width": width, "height": height, **attributes}
    return Html(
        "<img" + "".join(f' {name.rstrip("_")}="{text(value)}"' for name, value in given.items()) + ">"
    )


def folded(summary: object, *content: object) -> Html:
    """Something long that opens on a click."""
    return element("details", element("summary", summary), *content)
