"""A worker that makes every clip but one."""

from collections.abc import Callable
from typing import Any

from scenegen.foundation.errors import RejectedDrawError
from scenegen_datasets import studio

REFUSED = 2


def worker(setup: dict[str, Any]) -> Callable[[dict[str, Any], Any], dict[str, Any]]:
    make = studio.worker(setup)

    def refuse_one(payload: dict[str, Any], told: Any) -> dict[str, Any]:
        if payload["clip"] == REFUSED:
            raise RejectedDrawError("no free flight in this test")
        return make(payload, told)

    return refuse_one
