"""Ask the renderer who it is, in a process of its own: a library that aborts takes only that process with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from scenegen.foundation.errors import BackendError
from scenegen.foundation.pool import Done, Failed, Pool, Task


def render_fingerprint() -> dict[str, str]:
    """The renderer's part of the fingerprint (`scenegen_render.backend.Backend.fingerprint`).

    Raises
    ------
    BackendError
        If the renderer cannot start on this machine; one line.
    """
    with Pool("scenegen_datasets.probe:worker", {}, 1, strikes=1, silence_s=120.0) as pool:
        for event in pool.run([Task("renderer", "renderer", {})]):
            if isinstance(event, Done):
                return event.value
            if isinstance(event, Failed):
                remedy = "" if event.failure.exit_code is not None else "; run 'scenegen doctor'"
                raise BackendError(f"the renderer does not start: {event.failure.message}{remedy}")
    raise AssertionError("a pool ends every task")


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Any], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`."""

    def describe(payload: dict[str, Any], told: Any) -> dict[str, Any]:
        from scenegen_render import backend

        return dict(backend.describe().fingerprint())

    return describe
