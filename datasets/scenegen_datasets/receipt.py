"""What a finished clip holds, to be checked against its shard."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen_datasets.clip import ClipRecord


@dataclass(frozen=True)
class Receipt:
    """Proof of one committed clip.

    Attributes
    ----------
    clip : ClipRecord
    size : int
        Bytes of the shard.
    sha256 : str
        Of the shard.
    fingerprint : str
        Id of the render fingerprint the pixels were made with.
    """

    clip: ClipRecord
    size: int
    sha256: str
    fingerprint: str
