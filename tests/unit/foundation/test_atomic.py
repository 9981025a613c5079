"""The old file, the new file, or no file: never half of one."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from scenegen.foundation.atomic import (
    AtomicFile,
    is_partial,
    make_directories,
    remove,
    remove_partials,
    write_atomic,
)
from scenegen.foundation.errors import InputError


def names(directory: Path) -> set[str]:
    return {p.name for p in directory.iterdir()}


def test_nothing_is_visible_before_the_commit(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"old")
    with AtomicFile(path) as file:
        file.write(b"new ")
        file.write(memoryview(b"content"))
        assert path.read_bytes() == b"old"
        assert all(is_partial(n) for n in names(tmp_path) - {"a.bin"})
        file.commit()
    assert path.read_bytes() == b"new content"
    assert names(tmp_path) == {"a.bin"}


def test_an_error_inside_the_block_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError), AtomicFile(path) as file:
        file.write(b"new")
        raise ZeroDivisionError
    assert path.read_bytes() == b"old" and names(tmp_path) == {"a.bin"}


def test_the_order_is_sync_rename_sync(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []
    for name in ("fsync", "replace"):
        original = getattr(os, name)
        monkeypatch.setattr(os, name, lambda *a, n=name, f=original: (calls.append(n), f(*a))[1])
    write_atomic(tmp_path / "a", b"x")
    assert calls == ["fsync", "replace", "fsync"]


def test_the_same_content_is_not_written_again(tmp_path: Path) -> None:
    path = tmp_path / "a"
    write_atomic(path, b"x")
    before = path.stat().st_ino
    write_atomic(path, b"x")
    assert path.stat().st_ino == before
    write_atomic(path, b"y")
    assert path.stat().st_ino != before and path.read_bytes() == b"y"


def test_a_link_is_replaced_not_followed(tmp_path: Path) -> None:
    precious, link = tmp_path / "precious", tmp_path / "link"
    precious.write_bytes(b"keep")
    link.symlink_to(precious)
    write_atomic(link, b"new")
    assert precious.read_bytes() == b"keep"
    assert not link.is_symlink() and link.read_bytes() == b"new"


def test_the_mode_is_that_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").write_bytes(b"")
    write_atomic(tmp_path / "atomic", b"")
    assert (tmp_path / "atomic").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_directory_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write .*No such file"):
        AtomicFile(tmp_path / "no" / "a")


def test_directories_are_made_but_links_and_files_are_not_walked(tmp_path: Path) -> None:
    assert make_directories(tmp_path, "a/b/c") == tmp_path / "a/b/c"
    assert make_directories(tmp_path, "a/b/c").is_dir()
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "a")
    for name in ("file/x", "link/x"):
        with pytest.raises(InputError, match="link or a file"):
            make_directories(tmp_path, name)
    assert names(tmp_path / "a") == {"b"}


def test_orphans_are_recognised_by_name_only(tmp_path: Path) -> None:
    for name in (".a.tar.1-2.partial", ".b.tar.1-2.partial", "a.tar", ".hidden", "x.partial"):
        (tmp_path / name).touch()
    remove_partials(tmp_path, of="a.tar")
    assert names(tmp_path) == {".b.tar.1-2.partial", "a.tar", ".hidden", "x.partial"}
    remove_partials(tmp_path)
    assert names(tmp_path) == {"a.tar", ".hidden", "x.partial"}
    remove(tmp_path / "a.tar")
    remove(tmp_path / "a.tar")
    assert names(tmp_path) == {".hidden", "x.partial"}
