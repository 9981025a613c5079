"""A progress bar on standard error, whose figures stay whole on narrow terminals."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskProgressColumn, TextColumn
from rich.text import Text


class _What(ProgressColumn):
    """What is being done, on one line: with the bar, it gives way before the figures do."""

    def render(self, task: Task) -> Text:
        return Text(task.fields["what"], style="dim", no_wrap=True, overflow="ellipsis")


def progress_bar() -> Progress:
    """A bar for tasks with the fields `rate` and `what`; it leaves nothing behind when it ends."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[rate]}"),
        _What(),
    )
    return Progress(*columns, console=Console(stderr=True), transient=True)
