"""The process that reads hostile datasets: limited in memory and time, and watched.

A line of standard input names a reader, a dataset and a scratch folder, as JSON; a line of standard output says what
became of it, and how much memory the process ever took. Whatever a reader does but read what is sound or refuse in
one line is a failure: another exception, a hang, memory beyond the limit, a file opened for writing elsewhere.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hostile.readers import READERS
from scenegen.foundation.errors import ScenegenError

MEMORY_BYTES = 3 << 30
"""Address space: libraries map about half of it before the first dataset is read."""

CPU_S = 60
"""Per reader and dataset."""

LONGEST_REFUSAL = 2000

_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = {
    "os.remove": 1, "os.rename": 2, "os.link": 2, "os.symlink": -1, "os.mkdir": 1, "os.rmdir": 1, "os.truncate": 1,
    "os.chmod": 1, "os.chown": 1, "os.utime": 1, "os.setxattr": 1,
}  # fmt: skip
"""Audited calls to how many of their arguments are paths that change; of a symbolic link it is the second."""


class HangError(BaseException):
    """A reader used up its time."""


class Watch:
    """Hears of every file that Python opens, and notes those opened for writing outside the folders allowed."""

    def __init__(self) -> None:
        self.allowed: tuple[str, ...] = ()
        self.found: list[str] = []
        self._busy = False
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.allowed or self._busy:
            return
        self._busy = True
        try:
            for place in _changed(event, arguments):
                if not any(place == root or place.startswith(f"{root}/") for root in self.allowed):
                    self.found.append(f"{event} {place}")
        finally:
            self._busy = False


def _changed(event: str, arguments: tuple[Any, ...]) -> Iterator[str]:
    """Real places that an audited call changes."""
    if event == "open":
        path, _, flags = arguments
        if isinstance(path, str | bytes | os.PathLike) and flags & _WRITES and os.fspath(path) != os.devnull:
            yield _real(path, -1)
    elif event in _CHANGES:
        count = _CHANGES[event]
        paths = arguments[1:2] if count < 0 else arguments[:count]
        folders = [x for x in arguments[len(paths) :] if isinstance(x, int)][-len(paths) :]
        for k, path in enumerate(paths):
            if isinstance(path, str | bytes | os.PathLike):
                yield _real(path, folders[k] if k < len(folders) else -1)


def _real(path: Any, folder: int) -> str:
    """Where a name is: the folder followed through links, the last step not."""
    place = Path(os.fsdecode(path))
    if folder >= 0:
        place = Path(f"/proc/self/fd/{folder}").readlink() / place
    place = place.absolute()
    return str(place.parent.resolve() / place.name)


def outcome(name: str, root: Path, scratch: Path) -> str:
    """``sound``, ``refused``, or what went wrong."""
    signal.setitimer(signal.ITIMER_PROF, CPU_S)
    try:
        READERS[name].read(root, scratch)
        return "sound"
    except ScenegenError as error:
        told = " ".join(str(error).split())
        return "refused" if len(told) < LONGEST_REFUSAL else f"WRONG: {len(told)} letters: {told[:150]!a}"
    except HangError:
        return f"WRONG: used {CPU_S} s of processor time"
    except BaseException as error:  # whatever it is, it is what this looks for
        frames = traceback.extract_tb(error.__traceback__)
        where = " < ".join(f"{Path(f.filename).name}:{f.lineno}" for f in frames[:-5:-1])
        return f"WRONG: {type(error).__name__}: {str(error)[:150]!a} ({where})"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _hang(*_: object) -> None:
    raise HangError


def peak_MiB() -> int:
    """Resident memory at its highest, of this process and of any it waited for.

    Of a process, `getrusage` begins with what its parent had when it forked: right for our own children, not for us.
    """
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
        own = int(status.partition("VmHWM:")[2].split()[0])
    except OSError:
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return max(own, children) // 1024


def main() -> None:
    """Answer line after line."""
    from scenegen_datasets.codecs import single_threaded

    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints is no answer
    single_threaded()
    signal.signal(signal.SIGPROF, _hang)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    watch = Watch()
    for line in sys.stdin:
        name, root, scratch = json.loads(line)
        watch.found.clear()
        watch.allowed = (root, scratch)
        what = outcome(name, Path(root), Path(scratch))
        watch.allowed = ()
        if watch.found:
            what = f"WRONG: touches {watch.found[:3]!a}"
        answers.write(json.dumps([what, peak_MiB()]) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
