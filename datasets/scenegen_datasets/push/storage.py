"""Push to any file system of fsspec: nothing is known of a file but its size, so its content is read back."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.push.target import Item, There, side_by_side
from scenegen_datasets.remote.web import connected, tried

_CHUNK = 4 << 20
_LANES = 8
"""Files under way at once, where the file system allows it: most of a small file is waiting for the answer."""


class StorageTarget:
    """A URL that fsspec can write.

    Parameters
    ----------
    url : str
    options : mapping
        Of the file system.
    """

    def __init__(self, url: str, options: Mapping[str, Any]) -> None:
        self._url = url.rstrip("/")
        self._fs, self._root = connected(self._url, options)
        self._has_buckets = hasattr(
            self._fs, "split_path"
        )  # of fsspec's, those tell the bucket from the rest

    @property
    def where(self) -> str:
        """The URL."""
        return self._url

    @property
    def lanes(self) -> int:
        """Many where requests are asynchronous, as in object storage; others share one connection."""
        return _LANES if getattr(self._fs, "async_impl", False) else 1

    def listing(self) -> dict[str, There]:
        """All files with their sizes."""
        self._fs.invalidate_cache()
        try:
            found = tried(lambda: self._fs.find(self._root, detail=True), self._url)
        except FileNotFoundError:
            return {}
        skip = len(self._root.rstrip("/")) + 1
        return {path[skip:]: There(int(told["size"])) for path, told in found.items()}

    def read(self, path: str, max_bytes: int) -> bytes | None:
        """A small file."""
        place = self._place(path)
        try:
            data = bytes(tried(lambda: self._fs.cat_file(place, start=0, end=max_bytes + 1), place))
        except FileNotFoundError:
            return None
        if len(data) > max_bytes:
            raise DatasetError(f"{self._url}/{path}: larger than a sound file can be")
        return data

    def same(self, item: Item, there: There | None, quick: bool) -> bool:
        """Compare sizes, then contents."""
        if there is None or there.size != item.size:
            return False
        return quick or self._sha256(item.path) == item.sha256

    def send(self, root: Path, items: Sequence[Item]) -> None:
        """Write the files.

        Raises
        ------
        InputError
            If there is no such bucket. A push never makes one: most likely the name is mistyped.
        """
        side_by_side(self.lanes, self._send, items)

    def _send(self, item: Item) -> None:
        place = self._place(item.path)
        if not self._has_buckets:  # which hold no folders; asked for one, they would make the bucket
            self._fs.makedirs(place.rpartition("/")[0], exist_ok=True)
        try:
            tried(lambda: self._fs.put_file(str(item.file), place), place)
        except FileNotFoundError:
            raise InputError(
                f"{self._url}: there is no such bucket; make it first, or check its name and your access"
            ) from None

    def remove(self, paths: Sequence[str]) -> None:
        """Remove file by file."""
        for path in paths:
            place = self._place(path)
            try:
                tried(lambda: self._fs.rm_file(place), place)  # noqa: B023 - called at once
            except FileNotFoundError:
                continue

    def _sha256(self, path: str) -> str:
        found = hashlib.sha256()
        with tried(lambda: self._fs.open(self._place(path), "rb"), f"{self._url}/{path}") as file:
            while chunk := file.read(_CHUNK):
                found.update(chunk)
        return found.hexdigest()

    def _place(self, path: str) -> str:
        return f"{self._root}/{path}"
