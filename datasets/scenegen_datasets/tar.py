"""Plain ustar, the same bytes every time: no times, no owners, fixed mode, members in the order given.

Nothing of ours ever extracts a tar: members are read by offset, after their header has been found to be, byte for
byte, the one this module writes for that name and size.
"""

from __future__ import annotations

import tarfile

BLOCK = 512
_RECORD = 20 * BLOCK


def header(name: str, size: int) -> bytes:
    """Header block of a regular file."""
    info = tarfile.TarInfo(name)
    info.size = size
    return info.tobuf(tarfile.USTAR_FORMAT)


def padding(size: int) -> bytes:
    """Zeros that fill the last block of a member."""
    return bytes(-size % BLOCK)


def trailer(size: int) -> bytes:
    """What ends an archive of `size` bytes: two zero blocks, filled up to a full record as tar does."""
    return bytes(2 * BLOCK + -(size + 2 * BLOCK) % _RECORD)
