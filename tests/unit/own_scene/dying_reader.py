"""A reader that dies of what it reads."""

import os
import signal
from collections.abc import Callable
from typing import Any


def worker(setup: dict[str, Any]) -> Callable[..., dict[str, Any]]:
    def die(payload: dict[str, Any], emit: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
        os.kill(os.getpid(), signal.SIGSEGV)
        return {}

    return die
