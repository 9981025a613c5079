"""Text of strangers as it can be shown: a name from a file may move the cursor, or turn the direction of writing."""

from __future__ import annotations

import re

_ODD = re.compile(r"[^\x20-\x7e\xa1-\xac\xae-\u02ff]")
"""Letters that need a closer look."""


def printable(text: str) -> str:
    """One line of text with every letter escaped that is no letter, sign or blank: control characters, line ends,
    invisible marks that reorder what follows (U+202E), and halves of surrogate pairs, which no terminal could encode.
    """
    return text if text.isprintable() else _ODD.sub(_escaped, text)


def printable_lines(text: str) -> str:
    """The same, line by line; line ends stay."""
    return "\n".join(map(printable, text.split("\n")))


def printable_json(text: str) -> str:
    r"""A JSON document with the same letters written as ``\\u....``: it reads back to the same values."""
    return "\n".join(
        line if line.isprintable() else _ODD.sub(_escaped_json, line) for line in text.split("\n")
    )


def _escaped(match: re.Match[str]) -> str:
    letter = match[0]
    return letter if letter.isprintable() else letter.encode("unicode_escape", "surrogatepass").decode()


def _escaped_json(match: re.Match[str]) -> str:
    letter = match[0]
    if letter.isprintable():
        return letter
    units = letter.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{int.from_bytes(units[k : k + 2], 'big'):04x}" for k in range(0, len(units), 2))
