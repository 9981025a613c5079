"""Releases: what version is enough, what is refused with which words, and a history that survives growth and kills."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.info import info
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.seal import with_seal
from scenegen_datasets.verify import verify
from scenegen_datasets.versions.history import read_history
from scenegen_datasets.versions.release import release


@pytest.fixture
def grown(fakes: ModuleType, tmp_path: Path) -> Path:
    """Two clips released as 1.0.0, then grown to four."""
    root = Path(fakes.make(tmp_path / "dataset", 2))
    release(root, "1.0.0")
    return Path(fakes.make(root, 4))


def test_a_release_and_growth_propose_a_minor_version(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "dataset", 2)
    assert info(root).version == "1.0.0"
    first = release(root, "1.0.0")
    assert (first.before, first.changes, first.again) == ("", (), False)
    before = fakes.tree(root)
    fakes.make(root, 4)
    assert info(root).version == "1.1.0-dev"
    for path, data in before.items():
        if path.startswith(("shards", "receipts")) or path == "releases.json":
            assert fakes.tree(root)[path] == data
    with pytest.raises(
        InputError,
        match=r"1\.0\.1 says too little after 1\.0\.0: .*MINOR step .2 clips are new: city-00001-000",
    ):
        release(root, "1.0.1")
    second = release(root, "1.1.0")
    assert [str(c) for c in second.changes] == ["2 clips are new: city-00001-000, city-00001-001"]
    assert second.before == "1.0.0"
    assert info(root).version == "1.1.0"
    assert verify(root).ok
    assert len(PairDataset(root)) == 12
    history = read_history(root)
    assert history is not None
    assert [r.version for r in history.releases] == ["1.0.0", "1.1.0"]
    assert [r.counts["clips"] for r in history.releases] == [2, 4]
    assert len({r.content_id for r in history.releases}) == 2


def test_the_version_stands_in_every_file_that_names_it(grown: Path) -> None:
    release(grown, "2.0.0")
    assert "Version 2.0.0" in (grown / "README.md").read_text()
    assert json.loads((grown / "croissant.json").read_text())["version"] == "2.0.0"
    assert "releases.json" in (grown / "MANIFEST.sha256").read_text()
    done = subprocess.run(["sha256sum", "--quiet", "-c", "MANIFEST.sha256"], cwd=grown, check=False)
    assert done.returncode == 0


def test_releasing_again_writes_nothing_and_finishing_again_keeps_the_version(
    fakes: ModuleType, grown: Path
) -> None:
    release(grown, "1.4.0")
    before = fakes.tree(grown)
    assert release(grown, "1.4.0").again
    fakes.make(grown, 4)
    assert fakes.tree(grown) == before


@pytest.mark.parametrize(
    ("version", "message"),
    [
        ("1.0.0", "1.0.0 is not above 1.0.0, its last release; release it as"),
        ("0.9.0", "0.9.0 is not above 1.0.0, its last release; release it as"),
        ("1.0.7", r"a MINOR step .2 clips are new.*; release it as 1\.1\.0 or above"),
        ("1.1", "is not MAJOR.MINOR.PATCH"),
        ("v1.1.0", "is not MAJOR.MINOR.PATCH"),
        ("1.01.0", "is not MAJOR.MINOR.PATCH"),
        ("1.1.0-dev", "is not MAJOR.MINOR.PATCH"),
    ],
)
def test_versions_that_say_too_little_are_refused(
    fakes: ModuleType, grown: Path, version: str, message: str
) -> None:
    before = fakes.tree(grown)
    with pytest.raises(InputError, match=message):
        release(grown, version)
    assert fakes.tree(grown) == before


def test_changed_samples_need_a_major_version(fakes: ModuleType, tmp_path: Path) -> None:
    """A clip is made again with other pixels, as other software may do: named, with the layers that changed."""
    root = fakes.make(tmp_path / "dataset", 2)
    release(root, "1.0.0")
    job = fakes.jobs(2)[1]
    other = fakes.jobs(6)[5]
    for path in (job.shard, job.receipt):
        (root / path).unlink()
    frames = list(fakes.encoded(type(job)(other.ordinal, *vars_of(job))))
    fakes.commit_clip(root, fakes.record(job), frames, fingerprint=fakes.FINGERPRINT)
    fakes.finish(root, fakes.jobs(2))
    assert info(root).version == "2.0.0-dev"
    with pytest.raises(InputError, match=r"1 clip has another depth: city-00000-001.*release it as 2\.0\.0"):
        release(root, "1.7.0")
    assert release(root, "2.0.0").changes[0].clips == ("city-00000-001",)


def vars_of(job: object) -> tuple[object, ...]:
    return tuple(value for name, value in vars(job).items() if name != "ordinal")


def test_damage_and_unfinished_work_are_not_released(fakes: ModuleType, grown: Path) -> None:
    shard = grown / fakes.jobs(1)[0].shard
    data = bytearray(shard.read_bytes())
    data[len(data) // 2] ^= 1
    shard.write_bytes(data)
    with pytest.raises(DatasetError, match=r"verify found .* faults, such as shards/train"):
        release(grown, "1.1.0")
    (grown / "dataset.json").unlink()
    with pytest.raises(InputError, match="is not finished"):
        release(grown, "1.1.0")
    with pytest.raises(InputError, match="no dataset at"):
        release(grown / "nowhere", "1.1.0")
    assert main(["release", str(grown), "1.1.0"]) == 2


def test_clips_that_could_not_be_made_are_released_on_request_only(
    fakes: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root = fakes.make(tmp_path / "dataset", 2, done=False)
    fakes.finish(root, fakes.jobs(3))
    assert main(["release", str(root), "1.0.0", "--jobs", "1"]) == 2
    assert "without 1 of its clips (city-00001-000)" in capsys.readouterr().err
    assert main(["release", str(root), "1.0.0", "--jobs", "1", "--allow-missing", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["version"] == "1.0.0"
    assert info(root).missing == ("city-00001-000",)


def test_a_writer_keeps_others_out(fakes: ModuleType, grown: Path) -> None:
    before = fakes.tree(grown)
    with DirectoryLock(grown), pytest.raises(InputError, match="is being written by process"):
        release(grown, "1.1.0")
    assert fakes.tree(grown) == before


@pytest.mark.parametrize("damage", ["flip", "cut", "other", "newer", "empty"])
def test_a_damaged_history_is_said_in_one_line(
    grown: Path, damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = grown / "releases.json"
    data = bytearray(path.read_bytes())
    if damage == "flip":
        data[len(data) // 2] ^= 1
    texts = {"other": b"{}", "newer": b'{"schema_version": 2}', "empty": b"", "cut": bytes(data[:-9])}
    path.write_bytes(texts.get(damage, bytes(data)))
    assert main(["release", str(grown), "1.1.0"]) == 1
    said = capsys.readouterr().err.strip()
    assert "releases.json" in said and "\n" not in said and "a bug" not in said


@pytest.mark.parametrize(
    "change",
    [
        {"releases": []},
        {"releases": [{"version": "1.0.0"}]},
        {"releases": 3},
        {"last": {}},
        {"last": None},
        {"missing": [3]},
    ],
    ids=str,
)
def test_a_sealed_history_that_makes_no_sense_is_refused(grown: Path, change: dict[str, Any]) -> None:
    path = grown / "releases.json"
    body = {k: v for k, v in json.loads(path.read_bytes()).items() if k != "seal"}
    path.write_bytes(pretty(with_seal({**body, **change})))
    with pytest.raises(DatasetError, match=r"releases.json: not a history of releases"):
        read_history(grown)


def test_the_command_says_what_changed(grown: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["release", str(grown), "1.1.0", "--jobs", "1"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"{grown} is released as 1.1.0, content ")
    assert said[1:] == ["since 1.0.0:", "  MINOR  2 clips are new: city-00001-000, city-00001-001"]


def test_killed_at_any_step_a_release_is_old_or_unfinished_or_whole(
    fakes: ModuleType, grown: Path, tmp_path: Path, dies: Callable[..., bool]
) -> None:
    """Death at each call that touches the disk; then the same release again gives the same tree."""
    old = fakes.tree(grown)
    clean = Path(shutil.copytree(grown, tmp_path / "clean"))
    release(clean, "1.1.0")
    whole = fakes.tree(clean)
    seen = set()
    for number, step in enumerate(range(1, 99, 4)):
        root = Path(shutil.copytree(grown, tmp_path / f"killed{step}"))
        died = dies(step, lambda root=root: release(root, "1.1.0"))
        files = {name: data for name, data in fakes.tree(root).items() if not name.startswith(".")}
        if not died:
            assert files == whole
            break
        seen.add(_kind(files, old, whole))
        if number % 2:
            continue
        after = Path(shutil.copytree(root, tmp_path / f"after{step}"))
        if number % 4 == 0:
            fakes.make(after, 4)
        release(after, "1.1.0")
        assert fakes.tree(after) == whole, f"killed at step {step}"
    assert seen >= {"old", "unfinished"} and step > 20


def _kind(files: dict[str, bytes], old: dict[str, bytes], whole: dict[str, bytes]) -> str:
    if "dataset.json" not in files:
        return "unfinished"
    if files == whole:
        return "whole"
    history = {"releases.json": old["releases.json"]}  # is written first, and told by dataset.json last
    assert files | history == {name: data for name, data in old.items() if not name.startswith(".")}
    return "old"
