"""The page on exports says what the code says."""

from __future__ import annotations

from pathlib import Path

from scenegen_datasets.exports.options import GAINS
from scenegen_datasets.exports.registry import FORMATS

PAGE = Path(__file__).parents[3] / "docs/exports.md"


def test_table_of_formats_is_that_of_the_registry() -> None:
    rows = [line for line in PAGE.read_text().splitlines() if line.startswith("| `")]
    cells = [tuple(cell.strip() for cell in row.strip("|").split("|")) for row in rows]
    wanted = [(f"`{name}`", *each.row()[1:]) for name, each in FORMATS.items()]
    assert cells[: len(wanted)] == wanted


def test_page_names_every_gain_and_option() -> None:
    text = PAGE.read_text()
    flags = {f"--{name.replace('_', '-')}" for each in FORMATS.values() for name in each.heeds}
    assert all(flag in text for flag in flags) and all(f"`{gain}`" in text for gain in GAINS)


def test_no_format_promises_what_it_does_not_count() -> None:
    for name, each in FORMATS.items():
        assert all(word and not word[0].isupper() for word in each.invalid.values()), name
        assert len(each.row()) == 7 and all(each.row()), name
