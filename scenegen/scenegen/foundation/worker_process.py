"""The parent's end of one worker process: start it, talk to it, bury it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from multiprocessing.connection import Pipe
from typing import Any

from scenegen.foundation.agenda import Task


class WorkerProcess:
    """One running worker.

    Parameters
    ----------
    factory : str
        ``"module:name"`` of the handler's factory.
    setup : dict
        Plain JSON data for it.
    environment : mapping
        Variables added to the process's environment.

    Attributes
    ----------
    pid : int
    connection : multiprocessing.connection.Connection
        Readable when the worker says something or is gone.
    task : Task or None
        What it is at.
    group : str or None
        Group of its last task.
    ready : bool
        Whether it has built its handler.
    log : str
        Last lines it printed; filled when it has ended.
    """

    def __init__(self, factory: str, setup: dict[str, Any], environment: Mapping[str, str]) -> None:
        self.connection, theirs = Pipe(duplex=True)
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the worker
        # A process group of its own: Ctrl-C in a terminal reaches the parent alone, which then decides.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "scenegen.foundation.worker", str(theirs.fileno()), factory],
            env={**os.environ, **environment},
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
            process_group=0,
        )
        theirs.close()
        self.pid = self._process.pid
        self.task: Task | None = None
        self.group: str | None = None
        self.ready = False
        self.log = ""
        self._heard = time.monotonic()
        self._send(setup)

    def give(self, task: Task) -> None:
        """Hand a task over; its deadline starts now."""
        self.task, self.group, self._heard = task, task.group, time.monotonic()
        self._send(task.payload)

    def receive(self) -> tuple[str, dict[str, Any]]:
        """Read one message; EOFError if the process is gone."""
        kind, value = json.loads(self.connection.recv_bytes())
        self._heard = time.monotonic()
        self.ready = self.ready or kind == "ready"
        return kind, value

    def silent_s(self) -> float:
        """Seconds since the last sign of life."""
        return time.monotonic() - self._heard

    def kill(self) -> None:
        """SIGKILL, and wait: a dead worker holds neither memory nor files. A second call does nothing."""
        self._process.kill()
        self._process.wait()
        self.connection.close()
        if not self._log.closed:
            self._log.seek(max(0, self._log.seek(0, os.SEEK_END) - 2000))
            self.log = self._log.read().decode("utf-8", "replace")
            self._log.close()

    def bury(self) -> str:
        """Collect a process that closed its line, and say how it ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=5)  # a core dump may take a moment
        self.kill()
        code = self._process.returncode
        if code is not None and code < 0:
            return f"was killed by {signal.Signals(-code).name}"
        return f"exited with code {code}"

    def _send(self, value: Mapping[str, Any]) -> None:
        try:
            self.connection.send_bytes(json.dumps(value, allow_nan=False).encode())
        except OSError:
            return  # it died; the next read finds out and says how
