"""What ``--help`` prints, and how a missing argument is named."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import pytest
import tyro

from scenegen.foundation.errors import InputError
from scenegen_cli.helping import command_help, keys_help
from scenegen_cli.leaving import HelpShown
from scenegen_cli.main import main
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Base:
    """What others share."""

    json: bool = False
    """Report as JSON."""


@dataclass(frozen=True)
class Trial(Base):
    """Try everything.

    A second paragraph.
    """

    dataset: Annotated[Path, tyro.conf.Positional] = Path("here")
    """Directory."""
    jobs: int = 0
    """Processes."""
    span_m: tuple[float, float] = (1.0, 2.5)
    """From, to [m]."""
    split: Literal["train", "test"] = "test"
    """Which."""
    out: Path | None = None
    """Where to;
    over two lines."""
    seeds: tuple[int, ...] = ()
    """Any number."""
    map: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """May be repeated."""
    quiet: bool = True
    """Say nothing."""


@dataclass(frozen=True)
class Demanding:
    """Needs things."""

    old: Annotated[Path, tyro.conf.Positional]
    """The older one."""
    parts: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """The newer ones."""
    to: str
    """Format."""


def test_help_is_drawn_from_the_dataclass() -> None:
    assert command_help(Trial, "trial").splitlines() == [
        "usage: scenegen trial [DATASET] [flags]",
        "",
        "Try everything.",
        "",
        "A second paragraph.",
        "",
        "  [DATASET]  Directory. (here)",
        "",
        "flags:",
        "  --json                Report as JSON.",
        "  --jobs N              Processes. (0)",
        "  --span-m X X          From, to [m]. (1 2.5)",
        "  --split {train,test}  Which. (test)",
        "  --out PATH            Where to; over two lines.",
        "  --seeds N ...         Any number.",
        "  --map TEXT            May be repeated.",
        "  --no-quiet            Say nothing.",
        "  -h, --help            Show this, and stop.",
    ]


@pytest.mark.parametrize("columns", [40, 80, 300])
def test_lines_fit_the_terminal(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    keys = [
        ("seed", "word " * 40, 3),
        ("climate.hour", "Hour [h].", None),
        ("climate.wind_mps", "Wind.", (0.5, 3.0)),
    ]
    text = keys_help("keys:", keys, lambda key: "drawn")
    assert max(map(len, text.splitlines())) <= min(max(columns, 61), 110)
    assert text.endswith("(3)\n\n  --climate.hour  Hour [h]. (drawn)\n  --climate.wind-mps  Wind. (0.5 3)")


def test_every_command_explains_itself(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(HelpShown):
        parse(Trial, "trial", ["--jobs", "x", "--help"], "\nthe end")
    assert capsys.readouterr().out.endswith("Show this, and stop.\nthe end\n")
    assert main(["help", "info"]) == 0
    assert capsys.readouterr().out.startswith("usage: scenegen info DATASET [flags]\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "OLD is missing: The older one (see 'scenegen trial --help')"),
        (["a", "b"], "--to TEXT is missing: Format"),
        (["--form", "a"], "unknown flag '--form'"),
    ],
)
def test_what_is_missing_is_named_as_in_the_help(words: list[str], message: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(Demanding, "trial", words)
    assert str(caught.value).startswith(message)


def test_a_flag_without_its_values_is_refused() -> None:
    for words in (["--seeds"], ["--seeds", "--json"], ["here", "--seeds", "--jobs", "2"]):
        with pytest.raises(InputError, match="--seeds: a value is missing"):
            parse(Trial, "trial", words)
    assert parse(Trial, "trial", ["--seeds", "1", "-2"]).seeds == (1, -2)
