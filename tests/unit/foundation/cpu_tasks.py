"""A worker that says which kernel of linear algebra it was told to use."""

import os
from typing import Any

from scenegen.foundation.worker import Emit, Handler


def factory(_setup: dict[str, Any]) -> Handler:
    def handle(_payload: dict[str, Any], _emit: Emit) -> dict[str, Any]:
        return {"kernel": os.environ.get("OPENBLAS_CORETYPE", "")}

    return handle
