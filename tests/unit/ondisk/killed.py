"""Child process: make a dataset, and die by SIGKILL at the N-th call of a function that touches the disk.

Usage: ``python killed.py DIRECTORY CLIPS N [naive]``. Every call of ``os.write``, ``os.fsync``, ``os.replace`` and
``os.mkdir`` below counts as one step; N beyond the last step means a clean run. ``naive`` writes shards in place and
takes what exists for done: the control that must fail where the real writer does not.
"""

from __future__ import annotations

import itertools
import os
import pathlib
import signal
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import fakes
from scenegen_datasets import commit


def arm(step: int) -> None:
    steps = itertools.count(1)

    def counted(call):  # type: ignore[no-untyped-def]
        def wrapper(*args, **kwargs):  # type: ignore[no-untyped-def]
            if next(steps) == step:
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*args, **kwargs)

        return wrapper

    for name in ("write", "fsync", "replace", "mkdir"):
        setattr(os, name, counted(getattr(os, name)))


def naive() -> None:
    class InPlace:
        def __init__(self, path: pathlib.Path) -> None:
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)

        def write(self, data: bytes) -> None:
            half = len(data) // 2
            os.write(self._file, data[:half])
            os.write(self._file, data[half:])

        def commit(self) -> None:
            os.close(self._file)

        def __enter__(self) -> InPlace:
            return self

        def __exit__(self, *_: object) -> None:
            pass

    commit.AtomicFile = InPlace  # type: ignore[misc,assignment]
    fakes.finished = lambda root: {f"{p.parent.name}-{p.stem}" for p in (root / "shards").rglob("*.tar")}


if __name__ == "__main__":
    root, clips, step = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    if "naive" in sys.argv:
        naive()
    arm(step)
    fakes.make(root, clips)
