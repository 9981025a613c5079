"""Worker processes that may die: each is replaced, its task is tried again, and three strikes put a task aside.

A worker is an interpreter of its own, connected by one socket (`scenegen.foundation.worker`). The pool knows nothing of
what the tasks do. It is driven by iterating `Pool.run`, in one thread, and leaves no process behind however that ends:
normally, by an exception, by Ctrl-C, or by SIGKILL of the parent.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any

from scenegen.foundation.agenda import Agenda, Task
from scenegen.foundation.errors import ScenegenError
from scenegen.foundation.worker_process import WorkerProcess

STARTUP_DEATHS = 3


class WorkerSetupError(ScenegenError, RuntimeError):
    """No worker can be started; the message says why."""

    exit_code = 1


@dataclass(frozen=True)
class Failure:
    """Why a task did not come back with a result.

    Attributes
    ----------
    message : str
        One line.
    exit_code : int or None
        Of the user error that was raised; None for a bug, a crash or a hang.
    traceback : str
        Of an unexpected exception, or the last words of a dead worker; may be empty.
    died : bool
        Whether the worker went down over it, rather than to say what is wrong.
    """

    message: str
    exit_code: int | None = None
    traceback: str = ""
    died: bool = False


@dataclass(frozen=True)
class Note:
    """A running task says something."""

    task: Task
    data: dict[str, Any]


@dataclass(frozen=True)
class Done:
    """A task came back with a result."""

    task: Task
    value: dict[str, Any]


@dataclass(frozen=True)
class Strike:
    """A task failed and will be tried again on another occasion."""

    task: Task
    failure: Failure
    strike: int


@dataclass(frozen=True)
class Failed:
    """A task failed for good: a user error, or its last strike."""

    task: Task
    failure: Failure


Event = Note | Done | Strike | Failed


class Pool:
    """Up to `jobs` worker processes.

    Parameters
    ----------
    factory : str
        ``"module:name"`` of a callable that takes `setup` and returns a `scenegen.foundation.worker.Handler`.
    setup : mapping
        Plain JSON data, given to the factory once per worker.
    jobs : int
        Processes at most.
    environment : mapping
        Variables added to the children's environment before their interpreter starts.
    silence_s : float
        A worker that reports nothing for this long while it has a task is killed [s].
    strikes : int
        Attempts of a task that crashes, hangs or raises something unexpected.
    share_from : int
        See `scenegen.foundation.agenda.Agenda`.
    """

    def __init__(
        self,
        factory: str,
        setup: Mapping[str, Any],
        jobs: int,
        *,
        environment: Mapping[str, str] | None = None,
        silence_s: float = 600.0,
        strikes: int = 3,
        share_from: int = 1,
    ) -> None:
        self._factory, self._setup, self._jobs = factory, dict(setup), max(1, jobs)
        self._environment = dict(environment or {})
        self._silence_s, self._strikes, self._share_from = silence_s, max(1, strikes), share_from
        self._workers: list[WorkerProcess] = []
        self._struck: Counter[str] = Counter()
        self._startup_deaths = 0

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()

    @property
    def pids(self) -> tuple[int, ...]:
        """Process ids of the live workers."""
        return tuple(worker.pid for worker in self._workers)

    def kill(self) -> None:
        """End all workers now and wait for them."""
        for worker in self._workers:
            worker.kill()
        self._workers.clear()

    def run(self, tasks: Iterable[Task]) -> Iterator[Event]:
        """Do the tasks; yield what happens as it happens. Closing the iterator kills the workers.

        Raises
        ------
        WorkerSetupError
            If a worker cannot build its handler, or workers keep dying before they can.
        """
        agenda = Agenda(tasks, self._share_from)
        try:
            while True:
                self._dispatch(agenda)
                busy = [worker for worker in self._workers if worker.task is not None]
                if not busy:
                    return
                for worker in self._awake(busy):
                    yield from self._hear(worker, agenda)
                for worker in [w for w in busy if w.silent_s() > self._silence_s]:
                    worker.kill()
                    yield from self._died(worker, agenda, f"reported nothing for {self._silence_s:g} s")
        finally:
            self.kill()

    def _dispatch(self, agenda: Agenda) -> None:
        for worker in [w for w in self._workers if w.task is None]:
            task = agenda.take(worker.group, self._groups_without(worker))
            if task is not None:
                worker.give(task)
        while len(self._workers) < self._jobs:
            task = agenda.take(None, self._groups_without(None))
            if task is None:
                return
            worker = WorkerProcess(self._factory, self._setup, self._environment)
            self._workers.append(worker)
            worker.give(task)

    def _groups_without(self, worker: WorkerProcess | None) -> set[str]:
        return {
            w.group for w in self._workers if w is not worker and w.group is not None and w.task is not None
        }

    def _awake(self, busy: list[WorkerProcess]) -> list[WorkerProcess]:
        patience = max(0.0, min(self._silence_s - w.silent_s() for w in busy))
        awake = set(wait([w.connection for w in self._workers], timeout=min(patience + 0.01, 60.0)))
        return [w for w in self._workers if w.connection in awake]

    def _hear(self, worker: WorkerProcess, agenda: Agenda) -> Iterator[Event]:
        try:
            kind, value = worker.receive()
        except (EOFError, OSError):
            yield from self._died(worker, agenda, worker.bury())
            return
        task = worker.task
        if kind == "unready":
            raise WorkerSetupError(f"a worker cannot start: {value['message']}")
        if kind == "ready" or task is None:
            self._startup_deaths = 0
        elif kind == "note":
            yield Note(task, value)
        elif kind == "done":
            worker.task = None
            yield Done(task, value)
        else:
            worker.task = None
            failure = Failure(value["message"], value["exit_code"], value["traceback"])
            yield from self._strike(task, failure, agenda)

    def _died(self, worker: WorkerProcess, agenda: Agenda, how: str) -> Iterator[Event]:
        if worker not in self._workers:
            return
        self._workers.remove(worker)
        if not worker.ready:
            self._startup_deaths += 1
            if self._startup_deaths >= STARTUP_DEATHS:
                raise WorkerSetupError(f"workers die while they start: {how}")
        if worker.task is not None:
            yield from self._strike(
                worker.task, Failure(f"its worker {how}", None, worker.log, died=True), agenda
            )

    def _strike(self, task: Task, failure: Failure, agenda: Agenda) -> Iterator[Event]:
        self._struck[task.key] += 1
        if failure.exit_code is not None or self._struck[task.key] >= self._strikes:
            yield Failed(task, failure)
        else:
            agenda.put_back(task)
            yield Strike(task, failure, self._struck[task.key])


__all__ = ["Done", "Event", "Failed", "Failure", "Note", "Pool", "Strike", "Task", "WorkerSetupError"]
