"""All ways a dataset is made hostile, by name; each changes a copy of a sound one, drawn from its own generator."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hostile import documents, members, places
from hostile.chance import Rng


def nothing(root: Path, rng: Rng) -> None:
    """The control: a sound dataset."""


_ALL = (
    places.link, places.hard_link, places.linked_folder, places.planted, places.pipe, places.folder, places.names,
    places.sparse, places.garbage, members.member, members.tar_header, documents.receipt, documents.description,
    documents.lock, documents.words, documents.clips, documents.index, documents.index_header, documents.manifest,
)  # fmt: skip

MUTANTS: dict[str, Callable[[Path, Rng], None]] = {f.__name__: f for f in _ALL}
"""Name to mutation; those of documents re-seal what they forged."""
