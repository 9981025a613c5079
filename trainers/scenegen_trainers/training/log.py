"""The log of a training: one CSV row every so many steps, cut back when a training resumes."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

from scenegen.foundation.atomic import write_atomic

LOG = "log.csv"


class Log:
    """Rows so far. Holds nothing that differs between two runs, so that the file does not either.

    Parameters
    ----------
    out : Path
        Directory of the training.
    before : int
        Rows of later steps than this were written by a run that was killed, and are dropped.
    """

    def __init__(self, out: Path, before: int) -> None:
        self._path = out / LOG
        self._rows: list[dict[str, str]] = []
        if self._path.is_file():
            with self._path.open(newline="", encoding="utf-8") as file:
                self._rows = [row for row in csv.DictReader(file) if int(row["step"]) <= before]

    def add(self, step: int, values: Mapping[str, float]) -> None:
        """Append to the row of a step."""
        said = {name: f"{value:.6g}" for name, value in values.items()}
        if self._rows and self._rows[-1]["step"] == str(step):
            self._rows[-1] |= said
        else:
            self._rows.append({"step": str(step), **said})

    def write(self) -> None:
        """Put the whole log on disk."""
        names = list(dict.fromkeys(name for row in self._rows for name in row))
        text = io.StringIO()
        writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(self._rows)
        write_atomic(self._path, text.getvalue().encode())
