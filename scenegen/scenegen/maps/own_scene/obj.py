"""OBJ before it is parsed: vertices and faces only, under object names that are numbers.

The names of objects, groups and materials that the sidecar refers to are kept apart; material libraries are not read.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.limits import MAX_PIECES
from scenegen.maps.own_scene.raw import Names

_DIRECTIVE = re.compile(rb"^(?!v |vt |vn |f |v\t|vt\t|vn\t|f\t)[^\n]*$", re.MULTILINE)
_INDENT = re.compile(rb"^[ \t]+", re.MULTILINE)


@dataclass
class _Pieces:
    """The piece the reader is in, and all pieces so far."""

    object: str = ""
    group: str = ""
    material: str = ""
    known: dict[tuple[str, str, str], int] = field(default_factory=dict)

    def turn(self, line: re.Match[bytes]) -> bytes:
        """Take in a line that is neither vertex nor face; returns what takes its place."""
        word, _, rest = line[0].partition(b" ")
        name = rest.decode("utf-8", "replace").strip()[:200]
        if word == b"o":
            self.object, self.group = name, ""
        elif word == b"g":
            self.group = name
        elif word == b"usemtl":
            self.material = name
        else:
            return b""
        return b"o p%d" % self.number()

    def number(self) -> int:
        """Number of the piece the reader is in."""
        number = self.known.setdefault((self.object, self.group, self.material), len(self.known))
        if number >= MAX_PIECES:
            raise InputError(f"has more than {MAX_PIECES:,} parts; join some of them")
        return number


def prune_obj(data: bytes) -> tuple[bytes, dict[str, Names]]:
    """Prune an OBJ file.

    Returns
    -------
    data : bytes
        Vertices, faces, and an object ``p0``, ``p1``, ... for each combination of object, group and material.
    names : dict of str to Names
        Of each of these objects.
    """
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\\\n", b" ")
    pieces = _Pieces()
    pieces.number()
    text = b"o p0\n" + _DIRECTIVE.sub(pieces.turn, _INDENT.sub(b"", text)) + b"\n"
    owners: dict[tuple[str, str], int] = {}
    names = {}
    for (thing, group, material), number in pieces.known.items():
        owner = owners.setdefault((thing, group), len(owners))
        names[f"p{number}"] = Names(group or thing, thing, material, owner)
    return text, names
