"""Mutants of the pictures and of the tar around them; every checksum above what was forged is right."""

from __future__ import annotations

import contextlib
import hashlib
import io
import struct
import tarfile
import zlib
from collections.abc import Callable
from pathlib import Path

from hostile.chance import Rng, pick
from scenegen.foundation.errors import ScenegenError
from scenegen_datasets import tar
from scenegen_datasets.finish import derive
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.seal import sealed, unsealed


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png_bomb(data: bytes, rng: Rng) -> bytes:
    """A PNG whose pixels inflate to 64 MiB, with the header of `data` or one of 100,000 x 100,000 pixels."""
    head = data[16:29] if rng.uniform() < 0.5 else struct.pack(">IIBBBBB", 100_000, 100_000, 16, 0, 0, 0, 0)
    bomb = zlib.compress(bytes(64 << 20))
    more = pick(rng, (b"", _chunk(b"zTXt", b"a\0\0" + bomb), _chunk(b"iCCP", b"a\0\0" + bomb)))
    signature = b"\x89PNG\r\n\x1a\n"
    return signature + _chunk(b"IHDR", head) + more + _chunk(b"IDAT", bomb) + _chunk(b"IEND", b"")


def tiff_bomb(data: bytes, rng: Rng) -> bytes:
    """A TIFF one tag of which, or its number of values, is absurd."""
    at = int.from_bytes(data[4:8], "little")
    count = int.from_bytes(data[at : at + 2], "little")
    entry = at + 2 + 12 * int(rng.integers(count))
    field = struct.pack("<I", int(pick(rng, (0, 1, 0xFFFF, 2**31, 2**32 - 1, len(data)))))
    where = entry + int(pick(rng, (4, 8, 8)))
    return data[:where] + field + data[where + 4 :]


def exr_bomb(data: bytes, rng: Rng) -> bytes:
    """An EXR whose header promises another size, says one thing twice, or is scrambled."""
    window = data.index(b"dataWindow\0box2i\0")
    attribute = data[window : window + 21] + struct.pack("<4i", 0, 0, 99_999, 99_999)
    kind = int(rng.integers(4))
    if kind == 0:
        return data[:window] + attribute + data[window + len(attribute) :]
    if kind == 1:  # twice: one for our check, one for the library
        return data[:window] + attribute + data[window:]
    if kind == 2:
        view = data.index(b"displayWindow\0box2i\0") + 24
        return data[:view] + struct.pack("<4i", 0, 0, 2**31 - 1, 2**31 - 1) + data[view + 16 :]
    lines = data.index(b"type\0string\0")
    return data[:lines] + rng.bytes(200) + data[lines + 200 :]


def scrambled(data: bytes, rng: Rng) -> bytes:
    """A few bytes changed, most of them near the start."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 9))):
        changed[int(rng.integers(min(len(changed), 600) if rng.uniform() < 0.6 else len(changed)))] = int(
            rng.integers(256)
        )
    return bytes(changed)


_BOMBS = {"thermal.png": png_bomb, "depth.tiff": tiff_bomb, "flow.exr": exr_bomb, "truth.exr": exr_bomb}


def member(root: Path, rng: Rng) -> None:
    """A member is a bomb or scrambled."""
    path = pick(rng, receipt_paths(root))
    told = read_receipt(root, path)
    body = unsealed("receipt", (root / path).read_bytes(), "")
    data = (root / shard_of(path)).read_bytes()
    k = int(rng.integers(1, len(told.frames)))
    suffix = pick(rng, list(told.frames[k].members))
    bomb = rng.uniform() < 0.6
    change: Callable[[bytes, Rng], bytes] = _BOMBS.get(suffix, scrambled) if bomb else scrambled
    shard = io.BytesIO()
    for number, frame in enumerate(told.frames):
        for name, span in frame.members.items():
            content = data[span.offset : span.offset + span.size]
            if (number, name) == (k, suffix):
                content = change(content, rng)
            shard.write(tar.header(f"{frame.key}.{name}", len(content)))
            body["frames"][number]["members"][name] = [shard.tell(), len(content), zlib.crc32(content)]
            shard.write(content + tar.padding(len(content)))
    shard.write(tar.trailer(shard.tell()))
    _put(root, path, body, shard.getvalue())


def tar_header(root: Path, rng: Rng) -> None:
    """A member's header says something no dataset of ours says: pax, GNU, sparse, links, devices, sizes below zero."""
    path = pick(rng, receipt_paths(root))
    body = unsealed("receipt", (root / path).read_bytes(), "")
    frame = pick(rng, read_receipt(root, path).frames)
    suffix, span = pick(rng, list(frame.members.items()))
    data = bytearray((root / shard_of(path)).read_bytes())
    data[span.offset - tar.BLOCK : span.offset] = foreign_header(
        pick(rng, FOREIGN), f"{frame.key}.{suffix}", span.size
    )
    _put(root, path, body, bytes(data))


FOREIGN = (
    "pax", "pax-global", "gnu-name", "gnu-link", "sparse", "symlink", "hardlink", "device", "fifo", "folder", "dotdot",
    "absolute", "negative", "huge", "blank",
)  # fmt: skip
"""Headers that `foreign_header` makes."""

_TYPES = {
    "pax": tarfile.XHDTYPE, "pax-global": tarfile.XGLTYPE, "gnu-name": tarfile.GNUTYPE_LONGNAME,
    "gnu-link": tarfile.GNUTYPE_LONGLINK, "sparse": tarfile.GNUTYPE_SPARSE, "symlink": tarfile.SYMTYPE,
    "hardlink": tarfile.LNKTYPE, "device": tarfile.CHRTYPE, "fifo": tarfile.FIFOTYPE, "folder": tarfile.DIRTYPE,
}  # fmt: skip


def foreign_header(kind: str, name: str, size: int) -> bytes:
    """One tar block, its own checksum right, for a member of this name and size; `kind` is one of `FOREIGN`."""
    info = tarfile.TarInfo({"dotdot": f"../../{name}", "absolute": f"/tmp/{name}"}.get(kind, name))
    info.size, info.type = size, _TYPES.get(kind, tarfile.REGTYPE)
    if kind in ("symlink", "hardlink"):
        info.linkname = "/etc/passwd"
    block = bytearray(info.tobuf(tarfile.GNU_FORMAT)[: tar.BLOCK])
    if kind in ("negative", "huge"):  # base 256, as GNU writes sizes that octal digits cannot hold
        block[124:136] = b"\xff" * 12 if kind == "negative" else b"\x80" + bytes(4) + b"\xff" * 7
    if kind == "blank":
        block[:] = bytes(tar.BLOCK)
    block[148:156] = b" " * 8
    block[148:156] = b"%06o\0 " % sum(block)
    return bytes(block)


def _put(root: Path, path: str, body: dict[str, object], shard: bytes) -> None:
    """Write a forged shard, and everything that proves it."""
    (root / shard_of(path)).write_bytes(shard)
    assert isinstance(body["shard"], dict)
    body["shard"] |= {"sha256": hashlib.sha256(shard).hexdigest(), "size": len(shard)}
    (root / path).write_bytes(sealed("receipt", body))
    with contextlib.suppress(ScenegenError):  # a frame of a gigabyte is refused here already
        derive(root, sorted(read_receipt(root, p).clip.job for p in receipt_paths(root)), [])
