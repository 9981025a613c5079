"""``scenegen doctor``: check this machine and say what to do."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Doctor:
    """Render a few pixels in a child process, compare them with the closed form, and say what is wrong if any is."""

    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Doctor, "doctor", arguments)
    from scenegen_render.doctor import self_check

    report = self_check()
    if command.json:
        say_json({key: _plain(value) for key, value in asdict(report).items()})
        return 0 if report.healthy else 1
    rows = [("renderer", "works" if report.healthy else report.problem)]
    if report.advice:
        rows.append(("what to do", report.advice))
    if report.backend is not None:
        backend = report.backend
        rows += [
            ("backend", backend.variant),
            ("LLVM", f"{backend.llvm_version}  {backend.llvm_path}".strip()),
            ("CPU", f"{backend.cpu_model} ({backend.cpu_class})"),
            *backend.versions,
            ("pixels", f"radiance right to {report.radiance_error:.1e}, depth to {report.depth_error:.1e}"),
            ("first frame", f"{report.seconds:.1f} s"),
        ]
    say(table(rows))
    return 0 if report.healthy else 1


def _plain(value: Any) -> Any:
    """JSON has no NaN."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
