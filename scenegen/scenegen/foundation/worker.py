"""The inside of one worker process of `scenegen.foundation.pool`: take a task, do it, report, until the line closes.

Started as ``python -m scenegen.foundation.worker FD MODULE:FACTORY``. Only canonical JSON travels over the pipe, so a
worker shares no object with its parent and a crash cannot corrupt more than itself.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from scenegen.foundation.errors import ScenegenError

Emit = Callable[[dict[str, Any]], None]
"""Sends a note to the parent while a task runs; also the sign of life that moves its deadline."""

Handler = Callable[[dict[str, Any], Emit], dict[str, Any]]
"""Does one task: payload in, result out, both plain data."""


def describe(error: BaseException) -> dict[str, Any]:
    """An exception as plain data: one line for a user's error, the whole traceback for a bug."""
    user = isinstance(error, ScenegenError)
    trace = "" if user else "".join(traceback.format_exception(error))
    text = " ".join(str(error).split()) or type(error).__name__
    return {
        "type": type(error).__name__,
        "message": text if user else f"{type(error).__name__}: {text}",
        "exit_code": error.exit_code if isinstance(error, ScenegenError) else None,
        "traceback": trace,
    }


def die_with_parent() -> None:
    """Ask Linux to kill this process the moment its parent dies, even inside a long native call."""
    if sys.platform == "linux":
        parent_death_signal = 1  # PR_SET_PDEATHSIG
        ctypes.CDLL(None).prctl(parent_death_signal, signal.SIGKILL)


class _Line:
    """The pipe to the parent. A thread reads it, so that a closed pipe ends the process at once, wherever it is."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._tasks: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        threading.Thread(target=self._listen, name="line", daemon=True).start()

    def _listen(self) -> None:
        try:
            while True:
                self._tasks.put(json.loads(self._connection.recv_bytes()))
        except (EOFError, OSError):
            os._exit(0)

    def next(self) -> dict[str, Any]:
        return self._tasks.get()

    def send(self, kind: str, value: dict[str, Any]) -> None:
        self._connection.send_bytes(json.dumps([kind, value], allow_nan=False).encode())


def serve(connection: Connection, factory: str) -> None:
    """Build the handler from the first message, then answer tasks for ever."""
    line = _Line(connection)
    setup = line.next()
    try:
        module, name = factory.split(":")
        handler: Handler = getattr(importlib.import_module(module), name)(setup)
    except Exception as error:
        line.send("unready", describe(error))
        return
    line.send("ready", {"pid": os.getpid()})
    while True:
        payload = line.next()
        try:
            value = handler(payload, lambda note: line.send("note", note))
            line.send("done", value)
        except Exception as error:
            line.send("failed", describe(error))


def main() -> None:
    """Entry point of the child process."""
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides when to stop
    descriptor = int(sys.argv[1])
    os.set_inheritable(descriptor, False)
    serve(Connection(descriptor), sys.argv[2])


if __name__ == "__main__":
    main()
