"""Drives the child that reads hostile datasets (`hostile_datasets`), and watches what lies outside them."""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from hostile_datasets import MUTANTS, READERS, nothing

WRITERS = ("clean", "repair")


class Campaign:
    """A sound dataset, a scratch folder with something to protect, and a child with a memory limit.

    Parameters
    ----------
    sound : Path
        Dataset; only copied.
    scratch : Path
        An empty folder.
    """

    def __init__(self, sound: Path, scratch: Path) -> None:
        self._sound, self._root, self._outside = sound, scratch / "dataset", scratch / "outside"
        self._outside.mkdir()
        (self._outside / "prey").write_text("keep me")
        (self._outside / "city-00000").mkdir()
        (self._outside / "city-00000" / "000.json").write_text("{}")
        os.mkfifo(self._outside / "pipe")
        self._before = self._watched()
        self._start()

    def __enter__(self) -> Campaign:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    @property
    def peak_MiB(self) -> int:
        """Resident memory at the highest, of all children that ended."""
        self._stop()
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024

    def read(self, seed: int, kind: str | None = None) -> tuple[str, dict[str, str]]:
        """Make the mutant of this seed and let every reader at it; each reader gets a fresh copy."""
        names = sorted(MUTANTS)
        kind = kind or names[seed % len(names)]
        found = {}
        for reader in READERS:
            if reader in ("info", *WRITERS):  # the others leave it as it is
                self._plant(kind, seed)
            found[reader] = self._ask(reader)
            if self._watched() != self._before:
                found[reader] = "WRONG: something outside the dataset changed"
        return kind, found

    def _plant(self, kind: str, seed: int) -> None:
        subprocess.run(["rm", "-rf", str(self._root)], check=True)  # rmtree gives up in deep folders
        shutil.copytree(self._sound, self._root)
        {**MUTANTS, "nothing": nothing}[kind](self._root, np.random.default_rng(seed))

    def _ask(self, reader: str) -> str:
        assert self._child.stdin is not None and self._child.stdout is not None
        self._child.stdin.write(f"{reader} {self._root}\n")
        self._child.stdin.flush()
        line = self._child.stdout.readline()
        if not line:
            code = self._stop()
            self._start()
            return f"WRONG: the reader died with {code}"
        return str(json.loads(line))

    def _start(self) -> None:
        script = Path(__file__).with_name("hostile_datasets.py")
        self._child = subprocess.Popen(
            [sys.executable, str(script)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def _stop(self) -> int:
        """Let the reader end and close both pipes; returns how it ended."""
        with self._child:
            assert self._child.stdin is not None
            self._child.stdin.close()
            return self._child.wait(timeout=60)

    def _watched(self) -> dict[str, object]:
        return {
            str(p): (p.lstat().st_mtime_ns, p.read_bytes() if p.is_file() else b"")
            for p in sorted(self._outside.rglob("*"))
        }
