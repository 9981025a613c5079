"""``content_id``: one hash over all decoded arrays of a dataset, whatever compressed them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

from scenegen.foundation.canonical import canonical
from scenegen_datasets.receipt import Receipt


def clip_digest(receipt: Receipt) -> str:
    """SHA-256 over the clip's name and, frame by frame, the canonical JSON of its digests."""
    leaf = hashlib.sha256(receipt.clip.job.name.encode())
    for frame in receipt.frames:
        leaf.update(hashlib.sha256(canonical(dict(frame.digests))).digest())
    return leaf.hexdigest()


def content_id(clip_digests: Iterable[str]) -> str:
    """SHA-256 over the clips' digests in plan order."""
    root = hashlib.sha256()
    for digest in clip_digests:
        root.update(bytes.fromhex(digest))
    return root.hexdigest()
