"""A child whose readers make every mistake the campaign looks for: the control that must fail."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from hostile import child
from hostile.readers import READERS, Reader
from hostile.typed import check_said
from scenegen.foundation.errors import DatasetError


def _refuses_at_length(root: Path, scratch: Path) -> None:
    raise DatasetError("x" * 5000)


def _dies(root: Path, scratch: Path) -> None:
    os.abort()


def _takes_all_memory(root: Path, scratch: Path) -> None:
    bytearray(child.MEMORY_BYTES)


MISTAKES: dict[str, tuple[Callable[[Path, Path], object], str]] = {
    "raises": (lambda root, scratch: {}["x"], "KeyError"),
    "dies": (_dies, "died with -6"),
    "memory": (_takes_all_memory, "MemoryError"),
    "long": (_refuses_at_length, "5000 letters"),
    "prints": (lambda root, scratch: check_said("\x1b[2J"), "prints"),
    "writes beside": (lambda root, scratch: (root.parent / "new").write_text("x"), "touches"),
    "removes beside": (lambda root, scratch: (root.parent / "new").unlink(), "touches"),
    "makes beside": (lambda root, scratch: (root / ".." / "made").mkdir(), "touches"),
    "reads outside": (
        lambda root, scratch: (root.parent / "outside/prey").read_text(),
        "was read or changed",
    ),
    "hangs": (lambda root, scratch: (root.parent / "outside/pipe").read_text(), "it hangs"),
}
"""Name to what is done, and what the campaign must say of it."""


if __name__ == "__main__":
    for name, (do, _) in MISTAKES.items():
        READERS[name] = Reader(lambda root, scratch, do=do: do(root, scratch) and None)  # type: ignore[misc]
    child.main()
