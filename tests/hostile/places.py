"""Mutants of the tree itself: links, pipes, folders, names, sizes and files where others belong."""

from __future__ import annotations

import contextlib
import gzip
import os
from pathlib import Path

from hostile.chance import Rng, files, pick
from hostile.members import png_bomb


def link(root: Path, rng: Rng) -> None:
    """A file becomes a link to a pipe outside, which would block whoever opened it."""
    path = root / pick(rng, files(root))
    path.unlink()
    path.symlink_to(root.parent / "outside" / "pipe")


def hard_link(root: Path, rng: Rng) -> None:
    """A file becomes a second name of one outside, which whoever writes into it would change."""
    path = root / pick(rng, files(root))
    path.unlink()
    path.hardlink_to(root.parent / "outside" / "prey")


def linked_folder(root: Path, rng: Rng) -> None:
    """A folder becomes a link to one outside that holds the same names."""
    folders = ["shards", "receipts", "preview", "shards/train", "receipts/train", "shards/train/city-00000"]
    path = root / pick(rng, folders)
    path.rename(root / ".hidden")
    path.symlink_to(root.parent / "outside")


def planted(root: Path, rng: Rng) -> None:
    """What we write beside the data is there already, as a trap."""
    names = [
        ".lock",
        ".lock.claim",
        "run.log.jsonl",
        ".repair",
        "preview/report.html",
        ".index.npy.1-1.partial",
    ]
    path = root / pick(rng, names)
    path.unlink(missing_ok=True)
    outside = root.parent / "outside"
    traps = (
        lambda: path.symlink_to(outside / "prey"),
        lambda: path.symlink_to(outside / "new"),
        lambda: path.symlink_to(outside),
        lambda: path.hardlink_to(outside / "prey"),
        lambda: os.mkfifo(path),
        lambda: path.mkdir(),
        lambda: path.write_bytes(b"[" * 200_000),
        lambda: path.write_bytes(b'{"pid":1e400,"host":NaN}\n' * 9),
        lambda: path.write_bytes(b'{"time":[],"event":"quarantine"}\n{"time":"\x1b[2J","event":"start"}\n'),
        lambda: path.write_bytes(
            b'{"pid":100000000000000000000,"host":"' + os.uname().nodename.encode() + b'"}'
        ),
        lambda: (path.touch(), os.truncate(path, 1 << 40)),
    )
    pick(rng, traps)()


def pipe(root: Path, rng: Rng) -> None:
    """A file becomes a pipe nobody writes to."""
    path = root / pick(rng, files(root))
    path.unlink()
    os.mkfifo(path)


def folder(root: Path, rng: Rng) -> None:
    """A file becomes a folder."""
    path = root / pick(rng, files(root))
    path.unlink()
    path.mkdir()
    (path / "in it").touch()


def names(root: Path, rng: Rng) -> None:
    """Names that are not UTF-8, control the terminal, or end a line; folders four hundred deep."""
    where = os.fsencode(root / pick(rng, ("", "shards/train", "receipts/train", "preview")))
    evil = (
        b"\xff\xfe",
        b"\x1b[31mred",
        b"two\nlines",
        b"receipts",
        b".x.partial",
        b"CON",
        b"README.MD",
        "\u202egnp.fdp".encode(),
        b"<img src=x onerror=alert(1)>",
        b"\xc2\x9b2J",
    )
    for name in evil:
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
    os.truncate(root / pick(rng, files(root)), 1 << int(rng.integers(31, 42)))


def garbage(root: Path, rng: Rng) -> None:
    """A file is random, or repeats what costs parsers most."""
    path = root / pick(rng, files(root))
    aliases = b"a: &a [x,x]\n" + b"".join(
        b"%c: &%c [*%c,*%c]\n" % (c + 1, c + 1, c, c) for c in range(97, 121)
    )
    fills = (
        lambda: rng.bytes(4096),
        lambda: b"[" * 100_000,
        lambda: b'{"a":' * 50_000,
        lambda: b"\n" * 60_000_000,
        lambda: b"[]," * 1_300_000,
        lambda: b"9" * 10_000_000,
        lambda: b'"' + b"\\u0041" * 5_000_000 + b'"',
        lambda: aliases,
        lambda: b"\0" * 999,
        lambda: gzip.compress(bytes(64 << 20)),
        lambda: png_bomb(path.read_bytes() + bytes(40), rng),
    )
    path.write_bytes(pick(rng, fills)())
