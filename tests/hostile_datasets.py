"""Hostile datasets: a sound one, changed by somebody who knows the format and re-seals what he forged.

Run as a program, it is the child that reads them: on standard input it hears of a reader and a directory a line, and
answers what became of it. Whatever a reader does but give sound arrays or refuse in one line is a
failure: another exception, a hang, memory beyond the limit, a change outside the directory.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import resource
import signal
import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import ScenegenError
from scenegen_datasets import tar
from scenegen_datasets.finish import derive
from scenegen_datasets.index import ROW
from scenegen_datasets.manifest import manifest_bytes, read_manifest
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.seal import sealed, unsealed, with_seal

MEMORY_BYTES = 3 << 30
"""Address space of the child: libraries map about half of it before the first dataset is read."""

PATIENCE_S = 60
"""Per reader and dataset; a hang takes longer."""

NASTY: tuple[Any, ...] = (
    -1, 0, 2**31, 2**63, 2**64, 10**30, 10**400, 1e308, -1e308, 5e-324, True, None, "", "x" * 5000,
    "../../outside/prey", "/etc/passwd", "\x1b[2J\n", "a\0b", [], {}, [[]], {"a": {}}, [1] * 50, "100000",
    "shards/../../outside",
)  # fmt: skip

Rng = np.random.Generator


def _files(root: Path) -> list[str]:
    return sorted(str(p.relative_to(root)) for p in root.rglob("*") if p.is_file() and not p.is_symlink())


def _pick(rng: Rng, things: Any) -> Any:
    return things[int(rng.integers(len(things)))]


def link(root: Path, rng: Rng) -> None:
    """A file becomes a link to a pipe outside, which would block whoever opened it."""
    path = root / _pick(rng, _files(root))
    path.unlink()
    path.symlink_to(root.parent / "outside" / "pipe")


def linked_folder(root: Path, rng: Rng) -> None:
    """A folder becomes a link to one outside that holds the same names."""
    folders = ["shards", "receipts", "preview", "shards/train", "receipts/train", "shards/train/city-00000"]
    path = root / _pick(rng, folders)
    path.rename(root / ".hidden")
    path.symlink_to(root.parent / "outside")


def pipe(root: Path, rng: Rng) -> None:
    """A file becomes a pipe nobody writes to."""
    path = root / _pick(rng, _files(root))
    path.unlink()
    os.mkfifo(path)


def folder(root: Path, rng: Rng) -> None:
    """A file becomes a folder."""
    path = root / _pick(rng, _files(root))
    path.unlink()
    path.mkdir()
    (path / "in it").touch()


def names(root: Path, rng: Rng) -> None:
    """Names that are not UTF-8, control the terminal, or end a line; folders four hundred deep."""
    where = os.fsencode(root / _pick(rng, ("", "shards/train", "receipts/train", "preview")))
    for name in (b"\xff\xfe", b"\x1b[31mred", b"two\nlines", b"receipts", b".x.partial"):
        with contextlib.suppress(FileExistsError):
            folder = Path(os.fsdecode(where + b"/" + name))
            folder.mkdir()
            (folder / "000.json").touch()
    here = os.open(where, os.O_RDONLY)
    for _ in range(400):
        os.mkdir("deep", dir_fd=here)
        inner = os.open("deep", os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = inner
    os.close(here)


def sparse(root: Path, rng: Rng) -> None:
    """A file pretends to be enormous."""
    os.truncate(root / _pick(rng, _files(root)), 1 << int(rng.integers(31, 42)))


def garbage(root: Path, rng: Rng) -> None:
    """A file is random, or repeats what costs parsers most."""
    path = root / _pick(rng, _files(root))
    aliases = b"a: &a [x,x]\n" + b"".join(
        b"%c: &%c [*%c,*%c]\n" % (c + 1, c + 1, c, c) for c in range(97, 121)
    )
    fills = (
        rng.bytes(4096),
        b"[" * 100_000,
        b'{"a":' * 50_000,
        b"\n" * 300_000,
        b"[]," * 100_000,
        aliases,
        b"\0" * 999,
    )
    path.write_bytes(_pick(rng, fills))


def _leaf(value: Any, rng: Rng) -> tuple[Any, Any]:
    """A random place in a document: the container and the key."""
    while True:
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        key = _pick(rng, keys)
        inner = value[key]
        if not isinstance(inner, dict | list) or not inner or rng.uniform() < 0.15:
            return value, key
        value = inner


def _forge(body: Any, rng: Rng) -> None:
    place, key = _leaf(body, rng)
    action = rng.uniform()
    if action < 0.1:
        del place[key]
    else:
        place[key] = _pick(rng, NASTY)


def _dump(value: Any) -> bytes:
    return json.dumps(value, sort_keys=True, separators=(",", ":")).encode()


def receipt(root: Path, rng: Rng) -> None:
    """A receipt with absurd contents, sealed again; the dataset grows, so that readers must rely on it."""
    path = root / _pick(rng, receipt_paths(root))
    body = unsealed("receipt", path.read_bytes(), "")
    _forge(body, rng)
    path.write_bytes(sealed("receipt", body))
    if rng.uniform() < 0.5:
        (root / "dataset.json").unlink()


def description(root: Path, rng: Rng) -> None:
    """A ``dataset.json`` with absurd contents, sealed again."""
    path = root / "dataset.json"
    body = json.loads(path.read_bytes())
    body.pop("seal")
    _forge(body, rng)
    path.write_bytes(pretty(with_seal(body)))


def lock(root: Path, rng: Rng) -> None:
    """A lock with absurd contents; those who prove it are forged along."""
    path = root / "recipe.lock.json"
    body = json.loads(path.read_bytes())
    _forge(body, rng)
    path.write_bytes(_dump(body))
    _agree(root, ("recipe.lock.json",))


def clips(root: Path, rng: Rng) -> None:
    """A list of clips with absurd contents, in agreement with the description."""
    path = root / "clips.jsonl"
    lines = path.read_bytes().splitlines()
    k = int(rng.integers(len(lines)))
    body = json.loads(lines[k])
    _forge(body, rng)
    lines[k] = _pick(rng, (_dump(body), _dump(body), b"", b"[" * 5000, b'{"a":1e999}', b'"\\ud800"'))
    path.write_bytes(b"\n".join(lines) + b"\n")
    _agree(root, ("clips.jsonl",))


def index(root: Path, rng: Rng) -> None:
    """Index rows with absurd numbers and right checksums, in agreement with the description."""
    path = root / "index.npy"
    data = bytearray(path.read_bytes())
    base, size = len(data) % ROW.itemsize, ROW.itemsize
    for _ in range(int(rng.integers(1, 6))):
        at = base + size * int(rng.integers((len(data) - base) // size))
        name = _pick(rng, [n for n in ROW.names or () if n != "row_crc32"])
        kind, start = ROW.fields[name][:2]  # type: ignore[index]
        data[at + start : at + start + kind.itemsize] = _pick(
            rng, (rng.bytes(kind.itemsize), b"\xff" * kind.itemsize)
        )
        data[at + size - 4 : at + size] = struct.pack("<I", zlib.crc32(bytes(data[at : at + size - 4])))
    path.write_bytes(data)
    _agree(root, ("index.npy",))


def manifest(root: Path, rng: Rng) -> None:
    """Lines that lead out of the dataset, or name what is not there."""
    evil = (
        "../outside/prey",
        "/etc/passwd",
        "a/../../b",
        "no/such/file",
        "preview/../x",
        "shards/train",
        "\x1b",
    )
    with (root / "MANIFEST.sha256").open("ab") as file:
        file.write(f"{'0' * 64}  {_pick(rng, evil)}\n".encode())


def _agree(root: Path, files: tuple[str, ...]) -> None:
    """Bring description and manifest in line with changed files."""
    body = json.loads((root / "dataset.json").read_bytes())
    body.pop("seal")
    body["sums"] |= {name: hashlib.sha256((root / name).read_bytes()).hexdigest() for name in files}
    (root / "dataset.json").write_bytes(pretty(with_seal(body)))
    sums = read_manifest(root / "MANIFEST.sha256")
    sums |= {n: hashlib.sha256((root / n).read_bytes()).hexdigest() for n in ("dataset.json", *files)}
    (root / "MANIFEST.sha256").write_bytes(manifest_bytes(sums))


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _png_bomb(data: bytes, rng: Rng) -> bytes:
    head = data[16:29] if rng.uniform() < 0.5 else struct.pack(">IIBBBBB", 100_000, 100_000, 16, 0, 0, 0, 0)
    bomb = zlib.compress(bytes(64 << 20))
    return data[:8] + _chunk(b"IHDR", head) + _chunk(b"IDAT", bomb) + _chunk(b"IEND", b"")


def _set_tag(data: bytes, rng: Rng) -> bytes:
    at = int.from_bytes(data[4:8], "little")
    count = int.from_bytes(data[at : at + 2], "little")
    entry = at + 2 + 12 * int(rng.integers(count))
    field = struct.pack("<I", int(_pick(rng, (0, 1, 0xFFFF, 2**31, 2**32 - 1, len(data)))))
    where = entry + int(_pick(rng, (4, 8, 8)))
    return data[:where] + field + data[where + 4 :]


def _exr_bomb(data: bytes, rng: Rng) -> bytes:
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


def _scrambled(data: bytes, rng: Rng) -> bytes:
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 9))):
        changed[int(rng.integers(min(len(changed), 600) if rng.uniform() < 0.6 else len(changed)))] = int(
            rng.integers(256)
        )
    return bytes(changed)


def member(root: Path, rng: Rng) -> None:
    """A member is a bomb or scrambled, and every checksum above it is right."""
    path = _pick(rng, receipt_paths(root))
    told = read_receipt(root, path)
    body = unsealed("receipt", (root / path).read_bytes(), "")
    data = (root / shard_of(path)).read_bytes()
    k = int(rng.integers(1, len(told.frames)))
    suffix = _pick(rng, list(told.frames[k].members))
    bombs = {"thermal.png": _png_bomb, "depth.tiff": _set_tag, "flow.exr": _exr_bomb, "truth.exr": _exr_bomb}
    change: Callable[[bytes, Rng], bytes] = (
        bombs.get(suffix, _scrambled) if rng.uniform() < 0.6 else _scrambled
    )
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
    whole = shard.getvalue()
    (root / shard_of(path)).write_bytes(whole)
    body["shard"] |= {"sha256": hashlib.sha256(whole).hexdigest(), "size": len(whole)}
    (root / path).write_bytes(sealed("receipt", body))
    with contextlib.suppress(ScenegenError):  # a frame of a gigabyte is refused here already
        derive(root, sorted(read_receipt(root, p).clip.job for p in receipt_paths(root)), [])


def nothing(root: Path, rng: Rng) -> None:
    """The control: a sound dataset."""


MUTANTS: dict[str, Callable[[Path, Rng], None]] = {
    f.__name__: f
    for f in (link, linked_folder, pipe, folder, names, sparse, garbage, receipt, description, lock, clips, index,
              manifest, member)
}  # fmt: skip


def _read_all(root: Path) -> None:
    from scenegen_datasets import PairDataset
    from scenegen_datasets.layers import LAYERS

    pairs = PairDataset(root, allow_partial=True)
    stored = [x for x in LAYERS if x in pairs._source.layers]
    pairs = PairDataset(root, layers=stored, allow_partial=True)
    for k in range(len(pairs)):
        with contextlib.suppress(ScenegenError):
            pairs[k]


def _verify(root: Path) -> None:
    from scenegen_datasets.verify import verify

    print([str(f) for f in verify(root).findings][:3], file=sys.stderr)


def _info(root: Path) -> None:
    from scenegen_datasets.info import info

    str(info(root))


def _preview(root: Path) -> None:
    from scenegen_datasets.pictures.preview import draw_preview

    draw_preview(root)


def _repair(root: Path) -> None:
    """All of a repair but the renderer, which answers that it has other versions."""
    from scenegen_datasets.repair import remake
    from scenegen_datasets.repair.repair import repair

    remake.fingerprint_here = lambda: {"renderer": "none"}  # type: ignore[assignment]
    repair(root, 1)


def _clean(root: Path) -> None:
    from scenegen_datasets.repair.clean import clean

    clean(root)


READERS: dict[str, Callable[[Path], None]] = {
    "info": _info, "verify": _verify, "loader": _read_all, "preview": _preview, "clean": _clean, "repair": _repair,
}  # fmt: skip


class HangError(BaseException):
    """A reader did not come back."""


def _hang(*_: object) -> None:
    raise HangError


def outcome(reader: str, root: Path) -> str:
    """``sound``, ``refused``, or what went wrong."""
    signal.signal(signal.SIGALRM, _hang)
    signal.alarm(PATIENCE_S)
    try:
        READERS[reader](root)
        return "sound"
    except ScenegenError as error:
        one_line = str(error).isprintable() and len(str(error)) < 2000
        return "refused" if one_line else f"WRONG: an error of many lines: {str(error)[:200]!r}"
    except HangError:
        return "WRONG: it hangs"
    except BaseException as error:  # whatever it is, it is what this looks for
        import traceback

        where = traceback.extract_tb(error.__traceback__)[-1]
        return (
            f"WRONG: {type(error).__name__}: {str(error)[:150]} ({Path(where.filename).name}:{where.lineno})"
        )
    finally:
        signal.alarm(0)


if __name__ == "__main__":
    from scenegen_datasets.codecs import single_threaded

    single_threaded()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    for line in sys.stdin:
        reader, _, directory = line.strip().partition(" ")
        print(json.dumps(outcome(reader, Path(directory))), flush=True)
