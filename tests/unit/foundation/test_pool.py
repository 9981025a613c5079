"""The worker pool survives its workers: dead, hanging, raising, refusing to start, or orphaned."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from scenegen.foundation.agenda import Agenda
from scenegen.foundation.pool import Done, Event, Failed, Note, Pool, Strike, Task, WorkerSetupError

HERE = str(Path(__file__).parent)


def make_pool(jobs: int = 2, silence_s: float = 60.0, **setup: Any) -> Pool:
    return Pool(
        "pool_tasks:factory", setup, jobs, environment={"PYTHONPATH": HERE, "LANG": "C"}, silence_s=silence_s
    )


def task(name: str, group: str = "g", **payload: Any) -> Task:
    return Task(name, group, {"name": name, "group": group, **payload})


def of_kind(events: Iterable[Event], kind: type) -> list[Any]:
    return [event for event in events if isinstance(event, kind)]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False


def test_every_task_is_done_once_and_says_so() -> None:
    tasks = [task(f"t{i}", group=f"g{i % 3}") for i in range(9)]
    with make_pool() as pool:
        events = list(pool.run(tasks))
        assert pool.pids == ()
    assert sorted(e.value["name"] for e in of_kind(events, Done)) == [f"t{i}" for i in range(9)]
    assert sorted(e.data["at"] for e in of_kind(events, Note)) == [f"t{i}" for i in range(9)]
    assert not of_kind(events, Failed)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ("abort", "its worker was killed by SIGABRT"),
        ("segfault", "its worker was killed by SIGSEGV"),
        ("kill", "its worker was killed by SIGKILL"),
        ("exit", "its worker exited with code 7"),
        ("raise", "ZeroDivisionError: an unexpected thing"),
    ],
)
def test_a_fault_is_retried_and_leaves_the_others_alone(how: str, words: str, tmp_path: Path) -> None:
    tasks = [task("good"), task("bad", bad_attempts=2, how=how), task("fine")]
    events = list(make_pool(jobs=1, scratch=str(tmp_path)).run(tasks))
    assert {e.value["name"] for e in of_kind(events, Done)} == {"good", "bad", "fine"}
    strikes = of_kind(events, Strike)
    assert [(e.task.key, e.strike, e.failure.message) for e in strikes] == [
        ("bad", 1, words),
        ("bad", 2, words),
    ]
    if how == "abort":
        assert "the last words" in strikes[0].failure.traceback
    if how == "raise":
        assert "Traceback" in strikes[0].failure.traceback


def test_three_strikes_put_a_task_aside(tmp_path: Path) -> None:
    tasks = [task("bad", bad_attempts=9, how="kill"), task("good")]
    events = list(make_pool(jobs=1, scratch=str(tmp_path)).run(tasks))
    assert [e.task.key for e in of_kind(events, Failed)] == ["bad"]
    assert [e.value["name"] for e in of_kind(events, Done)] == ["good"]
    assert (tmp_path / "bad").read_text() == "xxx"


def test_a_users_error_is_not_tried_again(tmp_path: Path) -> None:
    events = list(make_pool(jobs=1, scratch=str(tmp_path)).run([task("bad", bad_attempts=9, how="input")]))
    (failed,) = of_kind(events, Failed)
    assert (failed.failure.message, failed.failure.exit_code) == ("the wish cannot be met", 2)
    assert failed.failure.traceback == ""
    assert (tmp_path / "bad").read_text() == "x"


def test_a_hanging_worker_is_killed_and_its_task_retried(tmp_path: Path) -> None:
    start = time.monotonic()
    pool = make_pool(jobs=1, silence_s=8.0, scratch=str(tmp_path))
    events = list(pool.run([task("slow", bad_attempts=1, how="hang")]))
    said = {e.failure.message for e in of_kind(events, Strike)}  # twice where it is slow to start, too
    assert said == {"its worker reported nothing for 8 s"}
    assert len(of_kind(events, Done)) == 1
    assert time.monotonic() - start < 300  # it would sleep for 1000


@pytest.mark.parametrize(
    ("setup", "message"),
    [
        ("refuse", "a worker cannot start: no such renderer"),
        ("bug", "a worker cannot start: ZeroDivisionError: in the factory"),
        ("die", "workers die while they start: was killed by SIGABRT"),
    ],
)
def test_a_pool_that_cannot_start_says_so_once(setup: str, message: str) -> None:
    with pytest.raises(WorkerSetupError, match=message):
        list(make_pool(**{setup: True}).run([task("t"), task("u", group="h")]))


def test_leaving_early_leaves_no_process() -> None:
    pool = make_pool()
    events = pool.run([task("a", sleep_s=100), task("b", group="h", sleep_s=100)])
    next(events)
    pids = pool.pids
    assert len(pids) == 2
    events.close()
    assert not any(alive(pid) for pid in pids)


def test_a_killed_parent_leaves_no_orphans() -> None:
    script = (
        "import sys; from test_pool import *\n"
        "pool = make_pool()\n"
        "for event in pool.run([task('a', sleep_s=100), task('b', group='h', sleep_s=100)]):\n"
        "    print(*pool.pids, flush=True)\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", script], cwd=HERE, stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    with parent.stdout:
        pids = [int(p) for p in parent.stdout.readline().split()]
        assert len(pids) == 2
        assert all(alive(pid) for pid in pids)
        parent.send_signal(signal.SIGKILL)
        parent.wait()
    deadline = time.monotonic() + 60
    while any(alive(pid) for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not any(alive(pid) for pid in pids)


def test_agenda_keeps_groups_together_and_shares_the_tail() -> None:
    agenda = Agenda([task(f"{g}{i}", group=g) for g in "abc" for i in range(4)], share_from=3)
    first, second = agenda.take(None, set()), agenda.take(None, {"a"})
    assert first is not None
    assert second is not None
    assert (first.key, second.key) == ("a0", "b0")
    assert [t.key for _ in range(3) if (t := agenda.take("a", {"b"}))] == ["a1", "a2", "a3"]
    third = agenda.take("a", {"b"})
    assert third is not None
    assert third.key == "c0"  # a fresh group before anyone else's
    shared = agenda.take("x", {"b", "c"})
    assert shared is not None
    assert shared.group == "b"  # nothing fresh: help where three are open
    assert agenda.take("x", {"b", "c"}).group == "c"  # type: ignore[union-attr]
    assert agenda.take("x", {"b", "c"}) is None  # two left each: not worth the preparation
    agenda.put_back(shared)
    assert agenda.take("x", {"b", "c"}) is shared
    assert len(agenda) == 4
