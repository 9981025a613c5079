"""Mutants of what describes the pictures: absurd values, well sealed, in agreement with each other."""

from __future__ import annotations

import hashlib
import json
import struct
import zlib
from pathlib import Path
from typing import Any

from hostile.chance import Rng, pick
from scenegen.foundation.canonical import pretty
from scenegen_datasets.index import ROW
from scenegen_datasets.manifest import manifest_bytes, read_manifest
from scenegen_datasets.receipt import receipt_paths
from scenegen_datasets.seal import sealed, unsealed, with_seal

MARK = "<img src=x onerror=alert(1)>"
"""What no page may hold as it is."""

TEXTS = (
    f"</script></style>{MARK}",
    '"><svg/onload=alert(1)>' + MARK,
    "\u202eevil\u2066",
    "\x9b2J\x85red",
    "\x1b]0;title\x07\x1b[2J\n",
    "a\0b",
    "../../outside/prey",
    "/etc/passwd",
    "shards/../../outside",
    "CON",
    "name: &a [*a]\n- !!python/object:os.system x",
    "[bold]x[/bold][link=http://x]",
    "{{7*7}}${7*7}%s%n",
    "x" * 5000,
    "",
)
"""Words that are dangerous to print, to put into a page or a path, or to read as YAML."""

NASTY: tuple[Any, ...] = (
    -1, 0, 2**31, 2**63, 2**64, 10**30, 10**400, 1e308, -1e308, 5e-324, True, None, [], {}, [[]], {"a": {}},
    [1] * 50, "100000", *TEXTS,
)  # fmt: skip
"""Values that belong nowhere."""


def _leaf(value: Any, rng: Rng) -> tuple[Any, Any]:
    """A random place in a document: the container and the key."""
    while True:
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        key = pick(rng, keys)
        inner = value[key]
        if not isinstance(inner, dict | list) or not inner or rng.uniform() < 0.15:
            return value, key
        value = inner


def _forge(body: Any, rng: Rng) -> None:
    place, key = _leaf(body, rng)
    action = rng.uniform()
    if action < 0.1:
        del place[key]
    elif action < 0.2 and isinstance(place, dict):
        place[pick(rng, TEXTS)] = place[key]
    else:
        place[key] = pick(rng, NASTY)


def _dump(value: Any) -> bytes:
    return json.dumps(value, sort_keys=True, separators=(",", ":")).encode()


def receipt(root: Path, rng: Rng) -> None:
    """A receipt with absurd contents, sealed again; half of the time the dataset grows, so that readers rely on it."""
    path = root / pick(rng, receipt_paths(root))
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
    agree(root, ("recipe.lock.json",))


def words(root: Path, rng: Rng) -> None:
    """Dangerous words wherever a document holds words, and everything agrees on them."""
    evil = pick(rng, TEXTS[:4])
    places = ("name", "license", "version", "git_sha")
    path = root / "recipe.lock.json"
    body = json.loads(path.read_bytes())
    body |= {name: evil for name in places if name != "version"}
    body["software"] = {evil: evil}
    body["fingerprint"][evil] = evil
    body["recipe"][evil] = evil
    path.write_bytes(_dump(body))
    agree(root, ("recipe.lock.json",))
    path = root / "dataset.json"
    told = json.loads(path.read_bytes())
    told.pop("seal")
    told |= {"name": evil, "license": evil, "maps": [evil], "missing": [evil], "members": [evil]}
    told["fingerprints"] = [{evil: evil}]
    told["ranges"][evil] = [0, 1]
    path.write_bytes(pretty(with_seal(told)))
    lines = [json.loads(line) for line in (root / "clips.jsonl").read_bytes().splitlines()]
    for line in lines:
        line["weather"][evil] = 1.0
        line["extra"] = {"style": evil, evil: evil}
        line["sensor"][evil] = evil
    (root / "clips.jsonl").write_bytes(b"".join(_dump(line) + b"\n" for line in lines))
    agree(root, ("clips.jsonl",))
    (root / "run.log.jsonl").write_bytes(
        _dump({"time": evil, "event": "start", "machine": {evil: evil, "host": evil}}) + b"\n"
        + _dump({"time": evil, "event": "quarantine", "clip": evil, "message": evil}) + b"\n"
    )  # fmt: skip


def clips(root: Path, rng: Rng) -> None:
    """A list of clips with absurd contents, in agreement with the description."""
    path = root / "clips.jsonl"
    lines = path.read_bytes().splitlines()
    k = int(rng.integers(len(lines)))
    body = json.loads(lines[k])
    honest = lines[k]
    _forge(body, rng)
    odd = (
        b"", b"[" * 5000, b'{"a":1e999}', b'"\\ud800"', b'{"a":NaN}', honest[:-1] + b',"hour":NaN}',
        honest[:-1] + b',"hour":3.0,"hour":4.0}', honest[:-1] + b',"x":"' + b"y" * (2 << 20) + b'"}',
        honest.replace(b'"hour":', b'"hour":' + b"1" * 5000), b"\n" * 50_000_000,
    )  # fmt: skip
    lines[k] = _dump(body) if rng.uniform() < 0.4 else pick(rng, odd)
    path.write_bytes(b"\n".join(lines) + b"\n")
    agree(root, ("clips.jsonl",))


def index(root: Path, rng: Rng) -> None:
    """Index rows with absurd numbers and right checksums, in agreement with the description."""
    path = root / "index.npy"
    data = bytearray(path.read_bytes())
    base, size = len(data) % ROW.itemsize, ROW.itemsize
    for _ in range(int(rng.integers(1, 6))):
        at = base + size * int(rng.integers((len(data) - base) // size))
        name = pick(rng, [n for n in ROW.names or () if n != "row_crc32"])
        kind, start = ROW.fields[name][:2]  # type: ignore[index]
        data[at + start : at + start + kind.itemsize] = pick(
            rng, (rng.bytes(kind.itemsize), b"\xff" * kind.itemsize)
        )
        data[at + size - 4 : at + size] = struct.pack("<I", zlib.crc32(bytes(data[at : at + size - 4])))
    path.write_bytes(data)
    agree(root, ("index.npy",))


def index_header(root: Path, rng: Rng) -> None:
    """An index of objects, of more rows than there are numbers, or of another version of the format."""
    path = root / "index.npy"
    data = path.read_bytes()
    length = 10 + int.from_bytes(data[8:10], "little")
    honest = data[10:length].decode("latin-1")
    frames = honest.partition("'shape': (")[2].partition(",")[0]
    texts = (
        "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        honest.replace(f"({frames},)", "(1000000000000,)"),
        honest.replace(f"({frames},)", "(-1,)"),
        honest.replace("False", "True "),
        honest.replace("'<u4'", "'|O4'", 1),
        "__import__('os').system('touch outside/new')",
        "(" * 30_000,
    )
    text = pick(rng, texts).encode("latin-1")
    version = pick(rng, (b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\xff\xff"))
    size = len(text).to_bytes(2 if version == b"\x01\x00" else 4, "little")
    path.write_bytes(data[:6] + version + size + text + data[length:])
    agree(root, ("index.npy",))


def manifest(root: Path, rng: Rng) -> None:
    """Lines that lead out of the dataset, name what is not there, or one file twice."""
    evil = (
        "../outside/prey", "/etc/passwd", "a/../../b", "no/such/file", "preview/../x", "shards/train", "\x1b",
        "README.md", "readme.MD", "con.txt", "preview/x.", "\u202ex",
    )  # fmt: skip
    with (root / "MANIFEST.sha256").open("ab") as file:
        file.write(f"{'0' * 64}  {pick(rng, evil)}\n".encode())


def agree(root: Path, changed: tuple[str, ...]) -> None:
    """Bring description and manifest in line with changed files."""
    body = json.loads((root / "dataset.json").read_bytes())
    body.pop("seal")
    body["sums"] |= {name: hashlib.sha256((root / name).read_bytes()).hexdigest() for name in changed}
    (root / "dataset.json").write_bytes(pretty(with_seal(body)))
    sums = read_manifest(root / "MANIFEST.sha256")
    sums |= {n: hashlib.sha256((root / n).read_bytes()).hexdigest() for n in ("dataset.json", *changed)}
    (root / "MANIFEST.sha256").write_bytes(manifest_bytes(sums))
