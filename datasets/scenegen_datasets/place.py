"""Where something large is about to be written: is that a directory, can it be made, and is there room?"""

from __future__ import annotations

import shutil
from pathlib import Path

from scenegen.foundation.errors import InputError, NoSpaceError
from scenegen.foundation.words import size


def existing_part(root: Path) -> Path:
    """Return the deepest part of `root` that is there already: `root` itself, or what it will be made in.

    Raises
    ------
    InputError
        If that is a file.
    OSError, ValueError
        If no such path can be looked at.
    """
    absolute = root.absolute()
    existing = next(p for p in (absolute, *absolute.parents) if p.exists())
    if not existing.is_dir():
        raise InputError(f"--out {root}: {existing} is a file; name a directory")
    return existing


def make_directory(path: Path, flag: str = "--out") -> None:
    """Make a directory that a user named, and what it lies in; one that is there stays as it is.

    Parameters
    ----------
    path : Path
    flag : str
        How the user named it, for the message.

    Raises
    ------
    InputError
        If it is a file, or cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"{flag} {path}: is a file; name a directory") from None
    except OSError as error:
        raise InputError(f"{flag} {path}: cannot be made: {error.strerror}; choose another {flag}") from None


def check_room(root: Path, existing: Path, need_bytes: float, instead: str) -> None:
    """Refuse what does not fit.

    Parameters
    ----------
    root : Path
        What is going to be written, for the message.
    existing : Path
        On the same device: `existing_part` of `root`.
    need_bytes : float
    instead : str
        What the user may do instead.

    Raises
    ------
    NoSpaceError
        If the device has less free.
    OSError
        If the device cannot be asked.
    """
    device = shutil.disk_usage(existing)
    if need_bytes > device.free and device.total > 0:  # a pseudo file system has no size at all
        raise NoSpaceError(
            f"{root}: about {size(need_bytes)} are needed and {size(device.free)} are free; {instead}"
        )
