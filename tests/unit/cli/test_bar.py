"""The progress bar, on terminals of several widths."""

import io

import pytest
from rich.console import Console

from scenegen_cli.bar import progress_bar

FIGURES = ("rendering", "100%", "2.4 frames/s  1:03:07 left")


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_figures_stay_whole_and_words_give_way(columns: int) -> None:
    bar = progress_bar()
    bar.add_task(FIGURES[0], total=1, completed=1, rate=FIGURES[2], what="clip 2/2  made city-00000-000")
    console = Console(width=columns, file=io.StringIO(), record=True)
    console.print(bar.get_renderable())
    (line,) = console.export_text().splitlines()
    assert all(figure in line for figure in FIGURES)
    assert "cli" in line
    assert line.endswith("made city-00000-000") == (columns == 200)
