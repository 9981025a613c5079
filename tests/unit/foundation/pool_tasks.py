"""What the workers of the pool tests do: behave, raise, hang, abort, be killed. Counts attempts in files."""

import os
import signal
import time
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.worker import Emit, Handler


def factory(setup: dict[str, Any]) -> Handler:
    if setup.get("refuse"):
        raise InputError("no such renderer")
    if setup.get("bug"):
        raise ZeroDivisionError("in the factory")
    if setup.get("die"):
        os.abort()

    groups: list[str] = []

    def handle(payload: dict[str, Any], emit: Emit) -> dict[str, Any]:
        attempt = 1
        if "scratch" in setup:
            mark = Path(setup["scratch"]) / payload["name"]
            attempt = len(mark.read_text()) + 1 if mark.exists() else 1
            mark.write_text("x" * attempt)
        groups.append(payload.get("group", ""))
        if attempt <= payload.get("bad_attempts", 0):
            _misbehave(payload["how"])
        emit({"at": payload["name"]})
        time.sleep(payload.get("sleep_s", 0.0))
        return {"pid": os.getpid(), "name": payload["name"], "groups": list(groups)}

    return handle


def _misbehave(how: str) -> None:
    if how == "abort":
        print("the last words", flush=True)
        os.abort()
    if how == "segfault":
        os.kill(os.getpid(), signal.SIGSEGV)
    if how == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if how == "exit":
        os._exit(7)
    if how == "hang":
        time.sleep(1000)
    if how == "raise":
        raise ZeroDivisionError("an unexpected\nthing")
    raise InputError("the wish cannot be met")
