"""The campaign of hostile datasets sees what it looks for: each mistake of a reader is told, and only mistakes are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hostile import campaign as module
from hostile.campaign import Campaign
from hostile.careless import MISTAKES
from hostile.readers import READERS, readers_of
from hostile.typed import check_said


def reading_shows(folder: Path) -> bool:
    """Whether this file system keeps the time of the last reading; some are mounted without."""
    file = folder / "file"
    file.write_text("x")
    os.utime(file, (1e9, 1e9))
    file.read_text()
    return file.stat().st_atime > 1e9


def test_each_mistake_is_told(pristine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PATIENCE_S", 3.0)
    told = [name for name in MISTAKES if name != "reads outside" or reading_shows(tmp_path)]
    with Campaign(pristine, tmp_path / "base", "hostile.careless") as campaign:
        found = campaign.read(0, "nothing", ("info", *told, "verify")).found
    assert {name: found[name] for name in ("info", "verify")} == {"info": "sound", "verify": "sound"}
    for name in told:
        said = MISTAKES[name][1]
        assert found[name].startswith("WRONG") and said in found[name], (name, found[name])


def test_what_a_terminal_may_get_is_no_mistake() -> None:
    check_said("Zürich: 3 µm\n  ok\n")
    for evil in ("\x1b", "\x9b", "\u202e", "\r", "\t", "\udc80"):
        with pytest.raises(Exception, match="prints"):
            check_said(f"a{evil}b")


def test_every_reader_has_its_turn() -> None:
    turns = [readers_of(seed) for seed in range(len(READERS))]
    assert {name for names in turns for name in names} == set(READERS)
    assert all({"verify", "load", "clean", "repair"} <= set(names) for names in turns)
