"""Damage a dataset in one place, see whether `verify` names it, `repair` it, and compare every byte.

    python benchmarks/damage.py [DIR] [--flips 40] [--seed 0] [--renders 3]

Every kind of file gets a flipped bit and a cut, at random places; then a missing receipt, a missing shard, two swapped
members, two swapped shards, links and pipes in place of files. `--renders` bounds how many of the repairs that need
the renderer are carried out (each builds a world), one of each kind first; the others are verified only. Without DIR,
a tiny dataset is rendered first. Exits with 1 if anything was not found, not named, or did not come back.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "system"))
import small

from scenegen.foundation.errors import ScenegenError
from scenegen_cli.main import main as scenegen
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.repair.clean import clean
from scenegen_datasets.repair.repair import repair
from scenegen_datasets.verify import verify

_NAMES_RECIPE = {"recipe.yaml", "dataset.json", "MANIFEST.sha256"}
"""The file that only a person can write again, and those that hold its sum."""


@dataclass(frozen=True)
class Damage:
    """One thing done to a dataset."""

    what: str
    file: str
    do: Callable[[Path], None]
    renders: bool

    @property
    def kind(self) -> str:
        """The same for damages that are alike."""
        return f"{self.what.split()[-1]} {self.file.partition('/')[0]}"


def damages(root: Path, rng: np.random.Generator, flips: int) -> Iterator[Damage]:
    """All that is tried; `root` is the sound dataset."""
    receipts = receipt_paths(root)
    files = sorted(small.tree(root))
    single = [f for f in files if not f.startswith(("shards/", "receipts/"))]
    for name in (*single, receipts[0], shard_of(receipts[-1])):
        heavy = name.startswith(("shards/", "receipts/"))
        for _ in range(1 if heavy else max(1, flips // len(single))):
            at, bit = int(rng.integers((root / name).stat().st_size)), int(rng.integers(8))
            yield Damage(f"bit {bit} of byte {at} flipped", name, _flip(name, at, bit), heavy)
        yield Damage("cut in half", name, _cut(name), heavy)
        yield Damage("removed", name, lambda root, name=name: (root / name).unlink(), heavy)
    for _ in range(flips):
        name = shard_of(receipts[int(rng.integers(len(receipts)))])
        at, bit = int(rng.integers((root / name).stat().st_size)), int(rng.integers(8))
        yield Damage(f"bit {bit} of byte {at} flipped", name, _flip(name, at, bit), True)
    yield Damage("two members swapped", shard_of(receipts[0]), _swap_members(receipts[0]), True)
    yield Damage("swapped with another shard", shard_of(receipts[0]), _swap_files(*receipts[:2]), True)
    for name, heavy in (("index.npy", False), (receipts[0], True), (shard_of(receipts[0]), True)):
        yield Damage("replaced by a pipe", name, _pipe(name), heavy)
        yield Damage("replaced by a link", name, _link(name), heavy)


def _flip(name: str, at: int, bit: int) -> Callable[[Path], None]:
    def do(root: Path) -> None:
        data = bytearray((root / name).read_bytes())
        data[at] ^= 1 << bit
        (root / name).write_bytes(data)

    return do


def _cut(name: str) -> Callable[[Path], None]:
    return lambda root: os.truncate(root / name, (root / name).stat().st_size // 2)


def _pipe(name: str) -> Callable[[Path], None]:
    def do(root: Path) -> None:
        (root / name).unlink()
        os.mkfifo(root / name)

    return do


def _link(name: str) -> Callable[[Path], None]:
    """The bytes are right and reached through a link, which a copy of the dataset would not have."""

    def do(root: Path) -> None:
        outside = root.parent / "outside"
        (root / name).replace(outside)
        (root / name).symlink_to(outside)

    return do


def _swap_members(path: str) -> Callable[[Path], None]:
    """Exchange the depth of two frames where it has the same size, else the counts of it."""

    def do(root: Path) -> None:
        receipt = read_receipt(root, path)
        a, b = (receipt.frames[k].members["flow.exr"] for k in (1, 2))
        assert a.size == b.size, "flow is not compressed"
        data = bytearray((root / shard_of(path)).read_bytes())
        one, two = data[a.offset : a.offset + a.size], data[b.offset : b.offset + b.size]
        data[a.offset : a.offset + a.size], data[b.offset : b.offset + b.size] = two, one
        (root / shard_of(path)).write_bytes(data)

    return do


def _swap_files(a: str, b: str) -> Callable[[Path], None]:
    def do(root: Path) -> None:
        one, two = root / shard_of(a), root / shard_of(b)
        one.rename(root / "hold")
        two.rename(one)
        (root / "hold").rename(two)

    return do


def trial(sound: Path, root: Path, damage: Damage, *, mend: bool) -> str:
    """Damage a copy, verify, repair; returns what went wrong, or ""."""
    shutil.rmtree(root, ignore_errors=True)
    shutil.copytree(sound, root)
    damage.do(root)
    try:
        named = [f.file for f in verify(root).findings]
    except ScenegenError as error:
        named = [str(error)]
    if not any(damage.file in name for name in named):
        return f"not named by verify, which said {named[:3]}"
    if not mend:
        return ""
    try:
        if "link" in damage.what:  # as verify says of it; repair writes over none
            clean(root)
        done = repair(root, 1)
    except ScenegenError as error:
        return f"refused: {error}"
    if not done.after.ok:
        return f"still {done.after.findings[0]}"
    now, then = small.tree(root), small.tree(sound)
    differ = sorted(name for name in now.keys() | then.keys() if now.get(name) != then.get(name))
    if done.rewritten and set(differ) <= _NAMES_RECIPE:
        return "rewritten: what was asked is lost, the samples are not"
    return f"other bytes in {', '.join(differ)}" if differ else ""


def _chosen(heavy: list[Damage], rng: np.random.Generator) -> list[Damage]:
    """In an order of chance, but one of each kind first."""
    shuffled = [heavy[k] for k in rng.permutation(len(heavy))]
    first = list({damage.kind: damage for damage in reversed(shuffled)}.values())
    return first + [damage for damage in shuffled if damage not in first]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dataset", type=Path, nargs="?")
    parser.add_argument("--flips", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--renders", type=int, default=12)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    wrong = mended = found = lost = 0
    with tempfile.TemporaryDirectory() as folder:
        sound = options.dataset or Path(folder) / "tiny"
        if options.dataset is None and scenegen(small.render(sound)) != 0:
            sys.exit("the dataset could not be rendered")
        start = time.process_time()
        tried = list(damages(sound, rng, options.flips))
        chosen = {id(d) for d in _chosen([d for d in tried if d.renders], rng)[: options.renders]}
        for damage in tried:
            mend = not damage.renders or id(damage) in chosen
            reason = trial(sound, Path(folder) / "copy", damage, mend=mend)
            beyond = damage.file == "recipe.yaml" and "flipped" not in damage.what
            if beyond and reason.startswith(("refused: ", "rewritten: ")):
                lost += 1
                print(f"{damage.file}: {damage.what}: {reason}")
                continue
            wrong += bool(reason)
            found, mended = found + 1, mended + mend
            if reason:
                print(f"WRONG {damage.file}: {damage.what}: {reason}", flush=True)
            elif damage.renders and mend:
                print(f"rendered again, the same bytes: {damage.file}: {damage.what}", flush=True)
        print(
            f"{len(tried)} damages: {found + lost} found and named, {mended} repaired to the same bytes, {lost} beyond "
            f"repair (the recipe, by more than a bit), {wrong} wrong; {time.process_time() - start:.0f} CPU s"
        )
    sys.exit(int(wrong > 0))


if __name__ == "__main__":
    main()
