"""What `merge` and `sense` do at their end: prove what they made, and say what was found."""

from __future__ import annotations

import shlex
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenegen.foundation.words import counted
from scenegen_cli.console import note

if TYPE_CHECKING:
    from scenegen_cli.progress import Meter
    from scenegen_datasets.verify import VerifyReport


def proven(root: Path, workers: int, meter: Meter, *, new: bool) -> VerifyReport:
    """Verify a dataset; one that is new and does not verify counts as unfinished."""
    from scenegen_datasets.verify import verify
    from scenegen_datasets.verify.proof import prove

    check = prove if new else verify
    return check(root, workers, progress=meter.verified)


def in_words(report: VerifyReport | None) -> str:
    """End of the line that says what was made."""
    if report is None:
        return ""
    return ", verified" if report.ok else f", {counted(len(report.findings), 'finding')}"


def facts(report: VerifyReport | None) -> dict[str, Any]:
    """The same for machines."""
    findings = [] if report is None else [asdict(finding) for finding in report.findings]
    return {"verified": None if report is None else report.ok, "findings": findings}


def exit_code(root: Path, report: VerifyReport | None, *, new: bool) -> int:
    """0, or 1 if anything was found; says what, and what to do."""
    if report is None or report.ok:
        return 0
    remedy = (
        f"{root} counts as unfinished: `scenegen repair` what it was made of, then run the same command again"
        if new
        else f"`scenegen repair {shlex.quote(str(root))}` puts it right"
    )
    note(f"verify found: {report.findings[0]}; {remedy}")
    return 1
