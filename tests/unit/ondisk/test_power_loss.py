"""Power cuts: what was not synced may be lost, torn or zeroed, and a rename may or may not have reached the disk.

A recorder follows every call that touches the disk while a dataset is made, and models two states of it: what programs
see, and what is sure to survive. At every call the power is cut: names that were not synced with their directory are
kept or lost, content that was not synced is kept, cut or zeroed. Whatever then counts as finished must be whole.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen_datasets.store import finished
from scenegen_datasets.verify import verify

Call = tuple[object, ...]


@dataclass
class Inode:
    content: bytearray = field(default_factory=bytearray)
    synced: bool = True


@dataclass
class Disk:
    """Directories map names to inodes; `sure` is what the last sync of each directory made durable."""

    seen: dict[Path, dict[str, Inode]] = field(default_factory=dict)
    sure: dict[Path, dict[str, Inode]] = field(default_factory=dict)
    open: dict[int, Inode | Path] = field(default_factory=dict)

    def apply(self, call: Call) -> None:
        name, *a = call
        if name == "mkdir":
            self.seen.setdefault(a[0], {})  # type: ignore[arg-type]
        elif name == "open":
            descriptor, path, created = a
            if created:
                self.open[descriptor] = self.seen.setdefault(path.parent, {}).setdefault(path.name, Inode())  # type: ignore
            else:
                self.open[descriptor] = path  # type: ignore
        elif name == "write":
            inode = self.open[a[0]]  # type: ignore[index]
            inode.content += a[1]  # type: ignore
            inode.synced = False  # type: ignore
        elif name == "fsync":
            target = self.open[a[0]]  # type: ignore[index]
            if isinstance(target, Inode):
                target.synced = True
            else:
                self.sure[target] = dict(self.seen.get(target, {}))
        elif name == "replace":
            old, new = a
            self.seen[new.parent][new.name] = self.seen[old.parent].pop(old.name)  # type: ignore
        elif name == "unlink":
            self.seen.get(a[0].parent, {}).pop(a[0].name, None)  # type: ignore

    def after_power_cut(self, root: Path, to: Path, rng: np.random.Generator) -> None:
        """Write down one state the disk may be found in."""
        lost = rng.uniform()
        for directory, seen in self.seen.items():
            sure = self.sure.get(directory, {})
            entries = dict(sure) if rng.uniform() < lost else dict(seen)
            place = to / directory.relative_to(root)
            place.mkdir(parents=True, exist_ok=True)
            for name, inode in entries.items():
                (place / name).write_bytes(inode.content if inode.synced else _torn(inode.content, rng))


def _torn(content: bytearray, rng: np.random.Generator) -> bytes:
    kind, at = rng.integers(4), int(rng.integers(len(content) + 1))
    return (
        bytes(content),
        bytes(content[:at]),
        bytes(len(content)),
        bytes(content[:at]) + bytes(len(content) - at),
    )[kind]


def record(monkeypatch: pytest.MonkeyPatch, synced: bool) -> list[Call]:
    """Follow the calls from now on; with `synced` false, as if every fsync were missing."""
    calls: list[Call] = []
    real = {name: getattr(os, name) for name in ("open", "write", "fsync", "replace", "mkdir", "unlink")}

    def opened(path: object, flags: int, *rest: object, **more: object) -> int:
        descriptor: int = real["open"](path, flags, *rest, **more)
        calls.append(("open", descriptor, Path(str(path)), bool(flags & os.O_CREAT)))
        return descriptor

    def written(descriptor: int, data: memoryview) -> int:
        count: int = real["write"](descriptor, data)
        calls.append(("write", descriptor, bytes(data[:count])))
        return count

    def followed(name: str, keep: bool = True) -> object:
        def call(*args: object, **more: object) -> object:
            result = real[name](*args, **more)
            if keep:
                calls.append((name, *(a if isinstance(a, int) else Path(str(a)) for a in args)))
            return result

        return call

    monkeypatch.setattr(os, "open", opened)
    monkeypatch.setattr(os, "write", written)
    monkeypatch.setattr(os, "fsync", followed("fsync", keep=synced))
    for name in ("replace", "mkdir", "unlink"):
        monkeypatch.setattr(os, name, followed(name))
    return calls


def states(calls: list[Call], root: Path, to: Path, rng: np.random.Generator, thin: int) -> Iterator[Path]:
    """States after a cut behind every `thin`-th call, and behind every call that is not a write."""
    disk = Disk(seen={root: {}}, sure={root: {}})
    for number, call in enumerate(calls):
        disk.apply(call)
        if call[0] in ("fsync", "replace", "unlink") or number % thin == 0:
            shutil.rmtree(to, ignore_errors=True)
            to.mkdir()
            disk.after_power_cut(root, to, rng)
            yield to


def wrong_clips(root: Path, clean: dict[str, bytes]) -> list[str]:
    """Clips that count as finished and are not what they should be."""
    shards = {name: f"shards/train/{name[:10]}/{name[11:]}.tar" for name in finished(root)}
    return [name for name, path in shards.items() if (root / path).read_bytes() != clean[path]]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_no_power_cut_leaves_a_clip_that_only_looks_whole(
    fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    root = tmp_path / "made"
    root.mkdir()
    with monkeypatch.context() as patch:
        calls = record(patch, synced=True)
        fakes.make(root, 2)
    clean = fakes.tree(root)
    rng = np.random.default_rng(seed)
    cuts = whole = 0
    for number, state in enumerate(states(calls, root, tmp_path / "state", rng, thin=3)):
        cuts += 1
        assert wrong_clips(state, clean) == []
        if (state / "dataset.json").exists() and (state / "dataset.json").read_bytes() == clean[
            "dataset.json"
        ]:
            whole += 1
            assert verify(state).ok
        if number % 25 == 0:
            fakes.make(state, 2)
            assert fakes.tree(state) == clean
    assert cuts > 60 and whole, (cuts, whole)


def test_without_syncs_the_same_cuts_do_harm(
    fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Negative control: the model finds the damage that the syncs prevent."""
    root = tmp_path / "made"
    root.mkdir()
    with monkeypatch.context() as patch:
        calls = record(patch, synced=False)
        fakes.make(root, 2)
    clean = fakes.tree(root)
    rng = np.random.default_rng(1)
    harm = sum(
        bool(wrong_clips(state, clean)) for state in states(calls, root, tmp_path / "state", rng, thin=1)
    )
    assert harm > 0
