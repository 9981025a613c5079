"""JSON files that prove their own wholeness: a flipped bit or a missing tail is found by whoever reads them next."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError
from scenegen_datasets.inside import read_inside

_MIDDLE = b',"sha256":"'
_TAIL = 64 + len(b'"}\n')


def sealed(name: str, body: Mapping[str, Any]) -> bytes:
    """Return ``{"<name>": body, "sha256": <of the body's canonical JSON>}`` and a newline."""
    text = canonical.canonical(body)
    return b'{"%s":%s%s%s"}\n' % (name.encode(), text, _MIDDLE, hashlib.sha256(text).hexdigest().encode())


def unsealed(name: str, data: bytes, where: str) -> dict[str, Any]:
    """Read what `sealed` returned.

    Raises
    ------
    DatasetError
        If the bytes are not whole, or the body is not a mapping.
    """
    value = canonical.parse(sealed_body(name, data, where), where)
    if not isinstance(value, dict):
        raise DatasetError(f"{where}: not a mapping")
    return value


def sealed_body(name: str, data: bytes, where: str) -> bytes:
    """Return the bytes of the body without parsing them.

    Raises
    ------
    DatasetError
        If the bytes are not whole.
    """
    head = b'{"%s":' % name.encode()
    body = data[len(head) : -_TAIL - len(_MIDDLE)]
    expected = b'%s%s%s%s"}\n' % (head, body, _MIDDLE, hashlib.sha256(body).hexdigest().encode())
    if data != expected:
        raise DatasetError(f"{where}: damaged (its own checksum does not match)")
    return body


def with_seal(body: Mapping[str, Any]) -> dict[str, Any]:
    """Return `body` with a field ``seal``: for files that people read, whose layout is not canonical."""
    return {**body, "seal": canonical.digest(dict(body))}


def check_seal(value: Any, where: str) -> dict[str, Any]:
    """Return the body of what `with_seal` made.

    Raises
    ------
    DatasetError
        If it was changed since.
    """
    if not isinstance(value, dict):
        raise DatasetError(f"{where}: not a mapping")
    body = {k: v for k, v in value.items() if k != "seal"}
    if value.get("seal") != canonical.digest(body):
        raise DatasetError(f"{where}: changed or damaged (its seal does not match)")
    return body


def read_bounded(path: Path, max_bytes: int) -> bytes:
    """Read a file that cannot soundly be larger than `max_bytes`; never through a symbolic link.

    Raises
    ------
    DatasetError
        If it is missing, a link, no plain file, or larger.
    """
    try:
        return read_inside(path.parent, path.name, max_bytes)
    except DatasetError as error:
        raise DatasetError(f"{path.parent}/{error}") from None
