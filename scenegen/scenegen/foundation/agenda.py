"""Which task next: groups stay on one worker as long as that keeps every worker busy."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Task:
    """One unit of work for a worker process.

    Attributes
    ----------
    key : str
        Unique name, for messages and counting strikes.
    group : str
        Tasks of one group share costly state inside a worker and are kept together.
    payload : dict
        Plain JSON data for the handler.
    """

    key: str
    group: str
    payload: dict[str, Any] = field(compare=False)


class Agenda:
    """Open tasks by group, in the order given.

    Parameters
    ----------
    tasks : iterable of Task
    share_from : int
        A group another worker is busy with is shared once at least this many of its tasks are open: sharing pays the
        group's preparation a second time, so it must save more than that.
    """

    def __init__(self, tasks: Iterable[Task], share_from: int = 1) -> None:
        self._open: dict[str, deque[Task]] = {}
        self._share_from = max(1, share_from)
        for task in tasks:
            self._open.setdefault(task.group, deque()).append(task)

    def __len__(self) -> int:
        return sum(len(tasks) for tasks in self._open.values())

    def take(self, current: str | None, busy: Collection[str]) -> Task | None:
        """Remove and return the next task for a worker that last worked on group `current`.

        Parameters
        ----------
        current : str or None
            The worker's last group; preferred while it has open tasks.
        busy : collection of str
            Groups other workers are at.

        Returns
        -------
        Task or None
            None if nothing is open, or nothing worth sharing.
        """
        group = current if current is not None and self._open.get(current) else self._fresh(busy)
        if group is None:
            return None
        tasks = self._open[group]
        task = tasks.popleft()
        if not tasks:
            del self._open[group]
        return task

    def put_back(self, task: Task) -> None:
        """Open a task again, first of its group."""
        self._open.setdefault(task.group, deque()).appendleft(task)

    def _fresh(self, busy: Collection[str]) -> str | None:
        for group in self._open:
            if group not in busy:
                return group
        longest = max(self._open, key=lambda g: len(self._open[g]), default=None)
        return longest if longest is not None and len(self._open[longest]) >= self._share_from else None
