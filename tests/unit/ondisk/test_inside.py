"""No path, whatever it says and whatever lies there, leads out of a directory, waits, or is believed about its size."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.inside import MAX_DEPTH, open_inside, read_inside, sha256_inside, walk
from scenegen_datasets.repair.remove import remove_inside

STEP = st.sampled_from(
    ["a", "b", "file", "..", ".", "", "out", "loop", "pipe", "/", "~", "\0", "x" * 300, "\udcff"]
)
PATHS = st.lists(STEP, min_size=1, max_size=5).map("/".join)
SECRET = b"secret"


@pytest.fixture(autouse=True)
def patience() -> Iterator[None]:
    """A pipe would keep the test waiting for ever."""
    signal.alarm(600)
    yield
    signal.alarm(0)


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Plain files two folders deep, and every kind of trap, with the same names on the other side of the links."""
    base = tmp_path_factory.mktemp("inside")
    outside, root = base / "outside", base / "root"
    for folder in (outside, root):
        (folder / "a" / "b").mkdir(parents=True)
    for place in ("file", "a/file", "a/b/file"):
        (outside / place).write_bytes(SECRET)
        (root / place).write_bytes(place.encode())
    (root / "out").symlink_to(outside)
    (root / "a" / "out").symlink_to(outside)
    (root / "a" / "loop").symlink_to(root)
    (root / "b").symlink_to(outside / "file")
    os.mkfifo(root / "pipe")
    return root


@given(PATHS)
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_only_plain_files_below_are_read(root: Path, path: str) -> None:
    honest = {"file", "a/file", "a/b/file"}
    try:
        found = read_inside(root, path, 100)
    except DatasetError as error:
        assert path not in honest and str(error).isprintable()
    else:
        assert path in honest and found == path.encode()


@given(PATHS)
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_refusal_leaves_no_descriptor_open(root: Path, path: str) -> None:
    before = _open_now()
    with contextlib.suppress(DatasetError):
        os.close(open_inside(root, path))
    with contextlib.suppress(DatasetError):
        sha256_inside(root, path, 2)
    assert _open_now() <= before


def _open_now() -> int:
    """Open descriptors; fewer than before where what an earlier test left is collected now."""
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


@given(st.integers(0, 40), st.integers(0, 40))
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_file_is_read_whole_or_refused_by_its_size(tmp_path: Path, size: int, limit: int) -> None:
    (tmp_path / "file").write_bytes(bytes(range(size)))
    if size <= limit:
        assert read_inside(tmp_path, "file", limit) == bytes(range(size))
        sha256_inside(tmp_path, "file", limit)
        return
    for read in (read_inside, sha256_inside):
        with pytest.raises(DatasetError, match=f"larger than the {limit} bytes"):
            read(tmp_path, "file", limit)


def test_a_walk_sees_everything_and_enters_no_link(root: Path) -> None:
    kinds = {entry.path: entry.kind for entry in walk(root)}
    assert kinds == {
        "a": "folder", "a/b": "folder", "a/b/file": "file", "a/file": "file", "file": "file", "a/out": "link",
        "a/loop": "link", "out": "link", "b": "link", "pipe": "other",
    }  # fmt: skip


def test_a_walk_goes_no_deeper_than_ours(tmp_path: Path) -> None:
    here = tmp_path
    for _ in range(MAX_DEPTH + 5):
        here = here / "d"
        here.mkdir()
    assert max(entry.path.count("/") + 1 for entry in walk(tmp_path)) == MAX_DEPTH


@given(path=PATHS)
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_nothing_outside_is_removed(root: Path, path: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    """In a copy of the tree, with its links: they go themselves, what they point to stays."""
    outside = root.parent / "outside"
    copy = tmp_path_factory.mktemp("copy") / "root"
    copy.mkdir()
    for entry in walk(root):
        place = copy / entry.path
        if entry.kind == "folder":
            place.mkdir()
        elif entry.kind == "link":
            place.symlink_to((root / entry.path).readlink())
        elif entry.kind == "file":
            place.write_bytes(b"x")
    before = {entry.path for entry in walk(copy)}
    try:
        remove_inside(copy, path)
    except (DatasetError, InputError) as error:
        assert str(error).isprintable()
        assert {entry.path for entry in walk(copy)} == before
    else:
        left = {entry.path for entry in walk(copy)}
        assert left == {p for p in before if p != path and not p.startswith(f"{path}/")}
    files = sorted(str(p.relative_to(outside)) for p in outside.rglob("*") if p.is_file())
    assert files == ["a/b/file", "a/file", "file"]
