"""Push to a dataset repository on the Hugging Face Hub: commits of many files, hashes kept by the Hub itself."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.push.target import HUB, Item, There
from scenegen_datasets.remote.web import tried

_PLACE = re.compile(re.escape(HUB) + r"([\w.-]+/[\w.-]+)(?:@([\w./-]+))?")
_KIND = "dataset"


class HubTarget:
    """A dataset repository.

    Parameters
    ----------
    repository : str
        ``USER/NAME``.
    revision : str or None
        Branch; the main one if None.
    api : huggingface_hub.HfApi
        Or what answers like it.
    """

    def __init__(self, repository: str, revision: str | None, api: Any) -> None:
        self._repository, self._revision, self._api = repository, revision, api

    @classmethod
    def at(cls, url: str, private: bool, options: Mapping[str, Any], api: Any = None) -> HubTarget:
        """Find the repository of ``hf://datasets/USER/NAME[@BRANCH]``; it is made if it is not there.

        Parameters
        ----------
        url : str
        private : bool
            Of a repository that is made.
        options : mapping
            Of ``HfApi``: ``token``, ``endpoint``; the same as those fsspec takes for reading.
        api : huggingface_hub.HfApi, optional
            Or what answers like it.

        Raises
        ------
        InputError
            If the URL is not of this form, or ``huggingface_hub`` is not installed.
        """
        match = _PLACE.fullmatch(url.rstrip("/"))
        if match is None:
            raise InputError(f"{url}: write {HUB}USER/NAME, or {HUB}USER/NAME@BRANCH")
        if api is None:
            try:
                from huggingface_hub import HfApi
            except ImportError:
                raise InputError(
                    "the Hub needs huggingface_hub: pip install 'thermal-scenegen[hf]'"
                ) from None
            api = HfApi(**options)
        repository, revision = match[1], match[2]
        hidden = True if private else None  # None leaves it to the rules of an organisation
        tried(lambda: api.create_repo(repository, repo_type=_KIND, private=hidden, exist_ok=True), url)
        if revision is not None:
            tried(lambda: api.create_branch(repository, branch=revision, repo_type=_KIND, exist_ok=True), url)
        return cls(repository, revision, api)

    @property
    def where(self) -> str:
        """The URL."""
        return f"{HUB}{self._repository}" + (f"@{self._revision}" if self._revision else "")

    @property
    def lanes(self) -> int:
        """One: a commit sends its files side by side already."""
        return 1

    def listing(self) -> dict[str, There]:
        """All files with what the Hub knows of their content."""
        entries = tried(
            lambda: list(
                self._api.list_repo_tree(
                    self._repository, recursive=True, revision=self._revision, repo_type=_KIND
                )
            ),
            self.where,
        )
        files = (entry for entry in entries if hasattr(entry, "blob_id"))
        return {
            file.path: There(
                file.size, file.lfs.sha256 if file.lfs else None, None if file.lfs else file.blob_id
            )
            for file in files
        }

    def read(self, path: str, max_bytes: int) -> bytes | None:
        """A small file."""
        there = self.listing().get(path)
        if there is None:
            return None
        if there.size > max_bytes:
            raise DatasetError(f"{self.where}/{path}: larger than a sound file can be")
        local = tried(
            lambda: self._api.hf_hub_download(
                self._repository, path, repo_type=_KIND, revision=self._revision
            ),
            f"{self.where}/{path}",
        )
        return Path(local).read_bytes()

    def same(self, item: Item, there: There | None, quick: bool) -> bool:
        """Compare sizes and the hashes the Hub keeps; nothing is read back."""
        if there is None or there.size != item.size:
            return False
        if there.sha256 is not None:
            return there.sha256 == item.sha256
        return there.git_sha1 == _git_sha1(item)

    def send(self, root: Path, items: Sequence[Item]) -> None:
        """Add files in one commit."""
        from huggingface_hub import CommitOperationAdd

        self._commit(
            [CommitOperationAdd(path_in_repo=item.path, path_or_fileobj=str(item.file)) for item in items],
            _told("Add", [item.path for item in items]),
        )

    def remove(self, paths: Sequence[str]) -> None:
        """Remove files in one commit."""
        from huggingface_hub import CommitOperationDelete

        if paths:
            self._commit([CommitOperationDelete(path) for path in paths], _told("Remove", paths))

    def _commit(self, operations: list[Any], message: str) -> None:
        tried(
            lambda: self._api.create_commit(
                self._repository,
                operations,
                commit_message=message,
                repo_type=_KIND,
                revision=self._revision,
            ),
            self.where,
        )


def _told(deed: str, paths: Sequence[str]) -> str:
    """Message of a commit."""
    return f"{deed} {paths[0] if len(paths) == 1 else f'{len(paths)} files'}"


def _git_sha1(item: Item) -> str:
    """Name git gives to a file of this content."""
    found = hashlib.sha1(b"blob %d\0" % item.size, usedforsecurity=False)
    with item.file.open("rb") as file:
        while chunk := file.read(1 << 20):
            found.update(chunk)
    return found.hexdigest()
