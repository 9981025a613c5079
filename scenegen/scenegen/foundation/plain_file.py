"""Open for writing a file that may exist already, and that somebody else may have put there.

A new file takes its place by renaming (`scenegen.foundation.atomic`), which never touches what stood there before. A
lock and a log are written where they are: planted as a link, symbolic or hard, such a name would hand out any file of
the user, and as a pipe it would hang whoever opens it.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

from scenegen.foundation.errors import InputError


def open_plain(path: Path, flags: int) -> int:
    """Open a plain file with this one name, or make it.

    Parameters
    ----------
    path : Path
        Its directory may be reached through links, it may not be one.
    flags : int
        Of ``os.open``, such as ``O_WRONLY | O_APPEND``; never ``O_TRUNC``, which would act before anything is checked.

    Returns
    -------
    int
        Descriptor; the caller closes it.

    Raises
    ------
    InputError
        If a link, a file with a second name, a pipe, a device or a directory is in its place.
    OSError
        If it cannot be opened for another reason.
    """
    assert not flags & os.O_TRUNC
    kept = os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        descriptor = os.open(path, flags | kept, 0o666)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise _refusal(path, "is a symbolic link") from None
        if error.errno in (errno.ENXIO, errno.EISDIR):
            raise _refusal(path, "is a pipe, a device or a directory") from None
        raise
    found = os.fstat(descriptor)
    plain = stat.S_ISREG(found.st_mode)
    if plain and found.st_nlink <= 1:  # 0 where another process has just removed the name
        return descriptor
    os.close(descriptor)
    raise _refusal(path, "is a hard link to another file" if plain else "is a pipe, a device or a directory")


def _refusal(path: Path, what: str) -> InputError:
    return InputError(f"{path} {what}, and would be written into; remove it")
