"""What a verification found."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.foundation.printable import printable


@dataclass(frozen=True, order=True)
class Finding:
    """One thing that is wrong.

    Attributes
    ----------
    file : str
        Path below the dataset; a member of a shard, or a frame of it, follows after ``: ``.
    reason : str
        Why it is not what it should be.
    """

    file: str
    reason: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "file", printable(self.file))
        object.__setattr__(self, "reason", printable(self.reason))

    def __str__(self) -> str:
        return f"{self.file}: {self.reason}"


@dataclass(frozen=True)
class VerifyReport:
    """Outcome of `verify`; `ok` if nothing was found.

    Attributes
    ----------
    findings : tuple of Finding
        Sorted by file.
    clips, frames, bytes : int
        What was looked at: bytes are those of the shards.
    quick : bool
        Whether pixels were left undecoded.
    """

    findings: tuple[Finding, ...]
    clips: int
    frames: int
    bytes: int
    quick: bool = False

    @property
    def ok(self) -> bool:
        """Whether nothing was found."""
        return not self.findings
