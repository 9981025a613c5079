"""Where the files of a dataset lie, and how pieces of them are read: a directory, or anything fsspec reaches."""

from __future__ import annotations

from scenegen_datasets.remote.files import Files, Root, files_at, is_url, plain_root

__all__ = ["Files", "Root", "files_at", "is_url", "plain_root"]
