"""Where a dataset is pushed to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar, runtime_checkable

from scenegen.foundation.errors import InputError
from scenegen_datasets.remote import is_url

HUB = "hf://datasets/"

Work = TypeVar("Work")
Done = TypeVar("Done")


@dataclass(frozen=True)
class Item:
    """A file to be pushed.

    Attributes
    ----------
    path : str
        Below the dataset.
    size : int
    sha256 : str
    file : Path
        Where it lies.
    """

    path: str
    size: int
    sha256: str
    file: Path


@dataclass(frozen=True)
class There:
    """What a place knows of a file without reading it.

    Attributes
    ----------
    size : int
    sha256, git_sha1 : str or None
        Of its content, and of the git blob that holds it, if the place keeps such a thing.
    """

    size: int
    sha256: str | None = None
    git_sha1: str | None = None


@runtime_checkable
class Target(Protocol):
    """A place that can be written."""

    @property
    def where(self) -> str:
        """For messages."""
        ...

    @property
    def lanes(self) -> int:
        """How many files may be under way at once."""
        ...

    def listing(self) -> dict[str, There]:
        """All files, by path."""
        ...

    def read(self, path: str, max_bytes: int) -> bytes | None:
        """A small file; None if it is not there."""
        ...

    def same(self, item: Item, there: There | None, quick: bool) -> bool:
        """Whether a file is there with the size and, unless `quick`, the content of `item`."""
        ...

    def send(self, root: Path, items: Sequence[Item]) -> None:
        """Write files, in any order."""
        ...

    def remove(self, paths: Sequence[str]) -> None:
        """Remove files, in this order or all at once; those that are not there are no error."""
        ...


def side_by_side(lanes: int, work: Callable[[Work], Done], items: Iterable[Work]) -> list[Done]:
    """Do work on items, so many at a time; the first error, or an interruption, calls off what has not begun.

    Parameters
    ----------
    lanes : int
        1 does one after the other, without a thread.
    work : callable
    items : iterable

    Returns
    -------
    list
        Results in the order of the items.
    """
    if lanes == 1:
        return [work(item) for item in items]
    with ThreadPoolExecutor(lanes) as pool:
        return list(pool.map(work, items))


def target_at(url: str, options: Mapping[str, Any], private: bool) -> Target:
    """Find the place of a URL.

    Raises
    ------
    InputError
        If it is not a URL, or what it needs is not installed.
    """
    if not is_url(url) and not url.startswith("file://"):
        raise InputError(f"{url} is not a URL, such as s3://bucket/name, {HUB}USER/NAME or file:///mnt/name")
    if url.startswith(("http://", "https://")):
        raise InputError(f"{url} can only be read; push to storage: s3://, gs://, {HUB}USER/NAME, file://")
    if url.startswith("hf://"):
        from scenegen_datasets.push.hub import HubTarget

        return HubTarget.at(url, private, options)
    from scenegen_datasets.push.storage import StorageTarget

    return StorageTarget(url, options)
