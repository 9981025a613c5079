"""``run.log.jsonl``: when, where and at what cost a dataset was made. Outside the manifest: it differs every time."""

from __future__ import annotations

import datetime
import json
import os
import platform
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any

from scenegen.foundation.atomic import explained
from scenegen.foundation.plain_file import open_plain
from scenegen_datasets.store import RUN_LOG

START = "start"
"""Event that begins a run; its line holds the lock beside `OF_THE_RUN`."""

OF_THE_RUN = ("time", "event", "pairs", "missing", "processes", "machine")
"""What the line of a start says of the run itself."""


class RunLog:
    """Appends one JSON object per line; a line is whole or absent.

    Parameters
    ----------
    root : Path
        Dataset directory.

    Raises
    ------
    InputError
        On entering, if the log cannot be written, or a link or a pipe lies in its place.
    NoSpaceError
        On entering, if the device is too full for an empty file.
    """

    def __init__(self, root: Path) -> None:
        self.path = root / RUN_LOG
        self._file: FileIO | None = None

    def __enter__(self) -> RunLog:
        try:
            descriptor = open_plain(self.path, os.O_WRONLY | os.O_APPEND)
        except OSError as error:
            raise explained(error, self.path) from None
        self._file = FileIO(descriptor, "a")  # unbuffered: what a full disk refuses is not tried again
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._file is not None:
            self._file.close()
        self._file = None

    def write(self, event: str, **facts: Any) -> None:
        """Append an event. A full disk silences the log, it does not stop the job."""
        now = datetime.datetime.now(datetime.UTC).isoformat(timespec="milliseconds")
        line = json.dumps({"time": now, "event": event, **facts}, ensure_ascii=False)
        try:
            assert self._file is not None
            self._file.write(f"{line}\n".encode(errors="backslashreplace"))
        except OSError:
            return


def machine() -> dict[str, Any]:
    """What this machine is, for the log."""
    cpus = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "host": platform.node(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "cpus": cpus,
    }
