"""One writer per directory.

The kernel's advisory lock decides, and vanishes with its holder, so nothing stale survives a crash. Where a file
system has no such locks, a file made with O_EXCL decides, and is taken over only from a process of this host that is
provably gone. The clock is never consulted.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import json
import os
import socket
from pathlib import Path
from types import TracebackType

from scenegen.foundation.atomic import explained, is_full
from scenegen.foundation.errors import InputError
from scenegen.foundation.plain_file import open_plain

_UNSUPPORTED = {errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL}
_MAX_HOLDER_BYTES = 4096


class DirectoryLock:
    """Exclusive right to write below a directory, held from ``with`` to its end.

    Parameters
    ----------
    directory : Path
        Must exist.
    name : str
        File of the lock inside it; gone again after the release.

    Raises
    ------
    InputError
        On entering, if another living process holds it, which is named with its host, or if a link or a pipe lies in
        the place of the lock.
    NoSpaceError
        On entering, if the device is too full for an empty file.
    """

    def __init__(self, directory: Path, name: str = ".lock") -> None:
        self.path = directory / name
        self._descriptor = -1

    def __enter__(self) -> DirectoryLock:
        while self._descriptor < 0:
            self._descriptor = self._attempt()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # Unlinked while still held: whoever opened this inode before sees in _attempt that the name has moved on.
        self.path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = -1

    def _attempt(self) -> int:
        """Return a held descriptor, or -1 if the holder was just leaving and another attempt is due."""
        try:
            descriptor = open_plain(self.path, os.O_RDWR)
        except OSError as error:
            if is_full(error):
                raise explained(error, self.path) from None
            raise InputError(
                f"cannot lock {self.path.parent}: {error.strerror or error}; make it writable, or work on a copy"
            ) from None
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            held = self._still_named(descriptor)
        except BlockingIOError:
            holder = _read_holder(descriptor)
            os.close(descriptor)
            raise self._busy(holder) from None
        except OSError as error:
            os.close(descriptor)
            if error.errno in _UNSUPPORTED:
                return self._attempt_without_flock()
            raise InputError(f"cannot lock {self.path.parent}: {error.strerror or error}") from None
        if not held:
            os.close(descriptor)
            return -1
        with contextlib.suppress(OSError):  # of a full device: the lock holds without a name in it
            _write_holder(descriptor)
        return descriptor

    def _attempt_without_flock(self) -> int:
        """Claim by exclusive creation of a second file; take it over only from a dead process of this host."""
        self.path.unlink(missing_ok=True)
        claim = self.path.with_name(self.path.name + ".claim")
        try:
            descriptor = os.open(
                claim, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666
            )
        except FileExistsError:
            holder = _holder_of(claim)
            if holder.get("host") == socket.gethostname() and not _alive(holder.get("pid")):
                claim.unlink(missing_ok=True)
                return -1
            raise self._busy(holder) from None
        try:
            _write_holder(descriptor)
        except OSError as error:  # a claim without a name could never be taken over
            os.close(descriptor)
            claim.unlink()
            raise explained(error, claim) from None
        self.path = claim
        return descriptor

    def _still_named(self, descriptor: int) -> bool:
        """Whether the locked inode is still the one under the name."""
        try:
            return os.path.samestat(os.fstat(descriptor), self.path.stat())
        except FileNotFoundError:
            return False

    def _busy(self, holder: dict[str, object]) -> InputError:
        who = f"process {holder.get('pid', '?')} on {holder.get('host', 'an unknown host')}"
        return InputError(
            f"{self.path.parent} is being written by {who}; wait for it, or stop it and try again"
        )


def _write_holder(descriptor: int) -> None:
    os.ftruncate(descriptor, 0)
    os.pwrite(descriptor, json.dumps({"host": socket.gethostname(), "pid": os.getpid()}).encode(), 0)


def _read_holder(descriptor: int) -> dict[str, object]:
    try:
        holder = json.loads(os.pread(descriptor, _MAX_HOLDER_BYTES, 0))
    except (OSError, ValueError, RecursionError):
        return {}
    return holder if isinstance(holder, dict) else {}


def _holder_of(path: Path) -> dict[str, object]:
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return {}
    try:
        return _read_holder(descriptor)
    finally:
        os.close(descriptor)


def _alive(pid: object) -> bool:
    if not isinstance(pid, int) or pid <= 0:
        return True  # unreadable: never take over what may be alive
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
