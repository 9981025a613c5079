"""Everything that reads a dataset, as a user runs it: the commands, the loader, the viewer's pictures."""

from __future__ import annotations

import contextlib
import importlib
import io
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hostile.documents import MARK
from scenegen.foundation.errors import ScenegenError
from scenegen_cli.console import complain

MOST_LETTERS = 2_000_000
"""No reader has more to say about a few clips."""


class SaidError(Exception):
    """A command printed what no terminal or page should get."""


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
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            try:
                importlib.import_module(f"scenegen_cli.{words[0]}").run(given)
            except ScenegenError as error:
                complain(" ".join(str(error).split()))  # as the command line does
                raise
            finally:
                check_said(said.getvalue())
        _check_pages(root, scratch)

    return read


def check_said(text: str) -> None:
    """Refuse text that controls a terminal, turns the direction of writing, or goes on for ever."""
    odd = next((c for c in text if c != "\n" and not c.isprintable()), None)
    if odd is not None:
        line = next(line for line in text.split("\n") if odd in line)
        raise SaidError(f"prints {odd!r}: {line[:120]!a}")
    if len(text) > MOST_LETTERS:
        raise SaidError(f"prints {len(text):,} letters")


def _check_pages(root: Path, scratch: Path) -> None:
    for page in (scratch / "out.html", root / "preview" / "report.html"):
        if page.is_file() and not page.is_symlink() and MARK in page.read_text("utf-8", "replace"):
            raise SaidError(f"{page.name} holds markup of the dataset")


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
