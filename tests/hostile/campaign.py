"""Gives hostile datasets to a child that reads them (`hostile.child`), and watches what lies outside."""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hostile.mutants import MUTANTS, nothing
from hostile.readers import READERS, readers_of
from scenegen_datasets.workers import ENVIRONMENT

PATIENCE_S = 60.0
"""A reader that sleeps so long waits for something that never comes; one that works has a limit of its own."""


_LONG_AGO_NS = 10**18


@dataclass(frozen=True)
class Read:
    """What became of one mutant.

    Attributes
    ----------
    seed : int
    kind : str
    found : dict of str to str
        Reader to ``sound``, ``refused``, or ``WRONG: ...``.
    peak_MiB : int
        Resident memory of the child at its highest so far.
    """

    seed: int
    kind: str
    found: dict[str, str]
    peak_MiB: int

    @property
    def wrong(self) -> dict[str, str]:
        """Readers that failed, and how."""
        return {name: what for name, what in self.found.items() if what.startswith("WRONG")}


class Campaign:
    """A sound dataset, a folder with something to protect beside its mutants, and a child that reads them.

    Parameters
    ----------
    sound : Path
        Dataset; only copied.
    base : Path
        An empty folder.
    child : str
        Module of the child.
    """

    def __init__(self, sound: Path, base: Path, child: str = "hostile.child") -> None:
        self._module = child
        self._base = base.resolve()
        self._sound, self._root = self._base / "sound", self._base / "dataset"
        self._scratch, self._outside = self._base / "scratch", self._base / "outside"
        shutil.copytree(sound, self._sound)
        self._outside.mkdir()
        (self._outside / "city-00000").mkdir()
        (self._outside / "city-00000" / "000.json").write_text("{}")
        (self._outside / "prey").write_text("keep me")
        os.mkfifo(self._outside / "pipe")
        self._places = [self._outside, *sorted(self._outside.rglob("*"))]
        self._shared: set[Path] = set()
        self._peak_MiB = 0
        self._start()

    def __enter__(self) -> Campaign:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def read(self, seed: int, kind: str | None = None, readers: tuple[str, ...] = ()) -> Read:
        """Make the mutant of this seed and let readers at it: those given, or those whose turn it is."""
        names = sorted(MUTANTS)
        kind = kind or names[seed % len(names)]
        found: dict[str, str] = {}
        fresh = False
        for name in readers or readers_of(seed // len(names) + seed):
            if not fresh:
                self._plant(kind, seed)
            found[name] = self._ask(name)
            fresh = name not in READERS or not READERS[name].writes
        return Read(seed, kind, found, self._peak_MiB)

    def _plant(self, kind: str, seed: int) -> None:
        _remove(self._root)
        shutil.copytree(self._sound, self._root)
        {**MUTANTS, "nothing": nothing}[kind](self._root, np.random.default_rng(seed))

    def _ask(self, name: str) -> str:
        _remove(self._scratch)
        self._scratch.mkdir()
        (self._scratch / "tmp").mkdir()
        before = self._watched(set_back=True)
        assert self._child.stdin is not None
        self._child.stdin.write(json.dumps([name, str(self._root), str(self._scratch)]).encode() + b"\n")
        self._child.stdin.flush()
        what = self._answer()
        after = self._watched()
        if after != before:
            changed = sorted(p for p in before.keys() | after.keys() if before.get(p) != after.get(p))
            return f"WRONG: {', '.join(changed)} outside the dataset was read or changed"
        return what

    def _answer(self) -> str:
        """The child's answer; a child that died, or that sleeps and will not wake, is replaced."""
        assert self._child.stdout is not None
        asleep_since, cpu = time.monotonic(), -1
        while not select.select([self._child.stdout], [], [], 1.0)[0]:
            runs, now = _work(self._child.pid)
            if runs or now != cpu:
                asleep_since, cpu = time.monotonic(), now
            if time.monotonic() - asleep_since > PATIENCE_S:
                self._end()
                self._start()
                return "WRONG: it hangs"
        line = self._child.stdout.readline()
        if not line:
            code = self._child.wait()
            self._end()
            self._start()
            return f"WRONG: the reader died with {code}"
        what, peak = json.loads(line)
        self._peak_MiB = max(self._peak_MiB, int(peak))
        return str(what)

    def _start(self) -> None:
        self._child = subprocess.Popen(
            [sys.executable, "-m", self._module],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=Path(__file__).parents[1],
            env={
                **os.environ,
                **ENVIRONMENT,  # a machine of many cores would reserve most of the address space for its threads
                "HOME": str(self._base),
                "TMPDIR": str(self._scratch / "tmp"),
                "PYTHONDONTWRITEBYTECODE": "1",
            },
        )

    def _end(self) -> None:
        self._child.kill()
        for pipe in (self._child.stdin, self._child.stdout):
            assert pipe is not None
            pipe.close()
        self._child.wait()

    def _watched(self, *, set_back: bool = False) -> dict[str, tuple[int, ...]]:
        """What lies outside: sizes, and the times of the last writing and reading; the latter can be set back first.

        A file with a second name in the dataset is a plain file there: to read it is no fault, to write into it is.
        """
        found: dict[str, tuple[int, ...]] = {}
        for path in self._places:  # listed once: to list a folder is to read it
            at = path.lstat()
            if set_back:
                os.utime(path, ns=(_LONG_AGO_NS, at.st_mtime_ns))
                at = path.lstat()
                self._shared = {*self._shared, path} if at.st_nlink > 1 else self._shared - {path}
            read_ns = 0 if path in self._shared and path.is_file() else at.st_atime_ns
            found[path.name] = (at.st_size, at.st_mtime_ns, read_ns)
        return found


def _remove(folder: Path) -> None:
    subprocess.run(["rm", "-rf", str(folder)], check=True)  # rmtree gives up in deep folders


def _work(pid: int) -> tuple[bool, int]:
    """Whether a process or one it started runs, and the clock ticks they have used."""
    found = [_state(pid)]
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):  # a thread, or a process, that has just ended
            found += [_state(int(child)) for child in task.read_text().split()]
    return any(state not in "SZ" for state, _ in found), sum(ticks for _, ticks in found)


def _state(pid: int) -> tuple[str, int]:
    """Whether a process runs or sleeps, as the kernel's letter, and the clock ticks it has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return fields[0], int(fields[11]) + int(fields[12])
