"""The front door: what it loads, what it says, how it leaves."""

import re
import sys
import types
from collections.abc import Callable
from pathlib import Path

import pytest

from scenegen.foundation.errors import BackendError, DatasetError, InputError, NoSpaceError
from scenegen_cli import main as door
from scenegen_cli.leaving import TerminatedError
from scenegen_cli.progress import Meter
from scenegen_datasets.run import Progress

Act = Callable[[list[str]], int]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Act], None]:
    """Put a function in the place of a subcommand."""

    def put(act: Act) -> None:
        module = types.ModuleType("scenegen_cli.trial")
        module.run = act  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "scenegen_cli.trial", module)
        monkeypatch.setitem(door.COMMANDS, "trial", "for this test")

    return put


def raising(error: BaseException) -> Act:
    def act(_: list[str]) -> int:
        raise error

    return act


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (InputError("no such thing"), 2),
        (BackendError("no such thing"), 2),
        (DatasetError("no such thing"), 1),
        (NoSpaceError("no such thing"), 4),
    ],
)
def test_a_users_error_is_one_line(
    error: Exception, code: int, command: Callable[[Act], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(raising(error))
    assert door.main(["trial"]) == code
    assert capsys.readouterr().err == "scenegen: no such thing\n"


def test_a_bug_is_one_line_that_names_the_traceback(
    command: Callable[[Act], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(raising(ZeroDivisionError("division\nby zero")))
    assert door.main(["trial"]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "ZeroDivisionError: division by zero" in said
    match = re.search(r"the traceback is in (\S+)", said)
    assert match is not None
    file = Path(match[1])
    assert "Traceback" in file.read_text(encoding="utf-8")
    file.unlink()


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt(), 130), (TerminatedError(), 143)])
def test_interrupts_have_their_exit_codes(
    error: BaseException, code: int, command: Callable[[Act], None]
) -> None:
    command(raising(error))
    assert door.main(["trial"]) == code


def test_every_listed_command_exists(capsys: pytest.CaptureFixture[str]) -> None:
    for name in door.COMMANDS:
        assert door.main([name, "--help"]) == 0
        assert f"scenegen {name}" in capsys.readouterr().out


def test_help_lists_all_commands_and_nothing_else_is_needed(capsys: pytest.CaptureFixture[str]) -> None:
    assert door.main(["--help"]) == 0
    said = capsys.readouterr().out
    assert all(f"  {name} " in said for name in door.COMMANDS)
    assert door.main([]) == 2


def test_plain_progress_is_a_line_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0
    monkeypatch.setattr("scenegen_cli.progress.time.monotonic", lambda: now)
    with Meter() as meter:
        for done in range(101):
            now = done * 1.0
            meter.frames(Progress(done, 100, done // 10, 10, "made a clip" if done % 10 == 0 else ""))
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 6  # every 15 s of 100
    assert lines[1] == "rendering   30 %  1.0 frames/s  1:10 left  clip 3/10  made a clip"
    with Meter(quiet=True) as meter:
        now = 500.0
        meter.frames(Progress(1, 2, 0, 1, "x"))
    assert capsys.readouterr().err == ""
