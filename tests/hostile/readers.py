"""Everything that reads a dataset, as a user runs it: the commands, the loader, the viewer's pictures."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hostile import makers
from hostile.typed import check_pages, typed
from scenegen.foundation.errors import ScenegenError


@dataclass(frozen=True)
class Reader:
    """One way to read a dataset.

    Attributes
    ----------
    read : callable
        Takes the dataset and a scratch folder; raises what goes wrong, `ScenegenError` where it refuses.
    writes : bool
        Whether it may change the dataset, so that the next reader needs a fresh copy.
    always : bool
        Whether it reads every mutant; the others take turns, because they cost more.
    """

    read: Callable[[Path, Path], None]
    writes: bool = False
    always: bool = False


def _command(*words: str) -> Callable[[Path, Path], None]:
    """A subcommand; ``DIR`` and ``OUT`` stand for the dataset and a path in the scratch folder."""

    def read(root: Path, scratch: Path) -> None:
        given = [word.replace("DIR", str(root)).replace("OUT", str(scratch / "out")) for word in words[1:]]
        typed(words[0], *given)
        check_pages(scratch / "out.html", root / "preview" / "report.html")

    return read


def _load(root: Path, scratch: Path) -> None:
    from scenegen_datasets import PairDataset
    from scenegen_datasets.layers import LAYERS
    from scenegen_datasets.source import open_source

    stored = [x for x in LAYERS if x in open_source(root, True).layers]
    pairs = PairDataset(root, layers=stored, allow_partial=True)
    for k in range(len(pairs)):
        with contextlib.suppress(ScenegenError):
            pairs[k]


def _view(root: Path, scratch: Path) -> None:
    from scenegen_datasets.view.gallery import Gallery, Tone
    from scenegen_datasets.view.library import Library

    library = Library(root)
    gallery = Gallery(library)
    for clip in library.clips[:3]:
        for layer in library.layers:
            with contextlib.suppress(ScenegenError):
                library.words(clip.position)
                library.path(clip.position)
                gallery.png(clip.position, 1, layer, Tone())


def _repair(root: Path, scratch: Path) -> None:
    """All of a repair but the renderer, which answers that it has other versions."""
    from scenegen_datasets.repair import remake

    remake.fingerprint_here = lambda: {"renderer": "none"}  # type: ignore[assignment]
    _command("repair", "DIR", "--jobs", "1")(root, scratch)


def _diff(root: Path, scratch: Path) -> None:
    sound = shutil.copytree(root.parent / "sound", scratch / "sound")
    _command("diff", str(sound), "DIR", "--pairs", "4")(root, scratch)


READERS: dict[str, Reader] = {
    "info": Reader(_command("info", "DIR"), always=True),
    "info --json": Reader(_command("info", "DIR", "--json")),
    "status": Reader(_command("status", "DIR"), always=True),
    "verify": Reader(_command("verify", "DIR", "--jobs", "1"), always=True),
    "verify --json": Reader(_command("verify", "DIR", "--jobs", "1", "--json", "--quick")),
    "load": Reader(_load, always=True),
    "view": Reader(_view),
    "preview": Reader(_command("preview", "DIR", "--out", "OUT")),
    "audit": Reader(_command("audit", "DIR", "--json")),
    "report": Reader(_command("report", "DIR", "--out", "OUT.html")),
    "diff": Reader(_diff),
    "export unpack": Reader(_command("export", "DIR", "--to", "unpack", "--out", "OUT", "--jobs", "1")),
    "export kitti": Reader(_command("export", "DIR", "--to", "kitti", "--out", "OUT", "--jobs", "1")),
    "export hdf5": Reader(_command("export", "DIR", "--to", "hdf5", "--out", "OUT", "--jobs", "1")),
    "push": Reader(_command("push", "DIR", "file://OUT")),
    "merge": Reader(makers.merge_linked),
    "sense": Reader(makers.sense),
    "merge renumbered": Reader(makers.merge_renumbered, writes=True),
    "release": Reader(_command("release", "DIR", "1.0.0", "--jobs", "1"), writes=True),
    "report inside": Reader(_command("report", "DIR"), writes=True),
    "preview inside": Reader(_command("preview", "DIR"), writes=True),
    "clean": Reader(_command("clean", "DIR"), writes=True, always=True),
    "repair": Reader(_repair, writes=True, always=True),
}
"""Those that change the dataset come last."""

TURNS = 2
"""So many of the readers that take turns read one mutant."""


def readers_of(seed: int) -> Sequence[str]:
    """Names of the readers that a mutant of this seed meets."""
    some = [name for name, reader in READERS.items() if not reader.always]
    mine = {some[(seed * TURNS + k) % len(some)] for k in range(TURNS)}
    return [name for name, reader in READERS.items() if reader.always or name in mine]
