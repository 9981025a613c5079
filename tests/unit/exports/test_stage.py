"""Where files are built: what a failure to write means, and that nothing of it stays."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError, NoSpaceError
from scenegen_datasets.exports.stage import Stage

FULL = OSError(errno.ENOSPC, "No space left on device")


def _full(*_: object, **__: object) -> None:
    raise FULL


@pytest.mark.parametrize(
    ("raised", "wanted", "said"),
    [
        (FULL, NoSpaceError, "no space left for"),
        (OSError(errno.EROFS, "Read-only file system"), InputError, "cannot write"),
        (NoSpaceError("said once"), NoSpaceError, "^said once$"),
        (RuntimeError("Can't decrement id ref count"), RuntimeError, "^Can't decrement id ref count$"),
        (KeyError("a bug of ours"), KeyError, "a bug of ours"),
    ],
)
def test_errors_of_libraries_become_lines(
    raised: Exception, wanted: type[Exception], said: str, tmp_path: Path
) -> None:
    with pytest.raises(wanted, match=said) as caught, Stage(tmp_path, "work") as stage:
        stage.put("picture.png", b"half")
        raise raised
    assert "\n" not in str(caught.value) and not list(tmp_path.iterdir())


def test_a_library_that_does_not_say_that_the_device_is_full(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(Path, "write_bytes", _full)
    with pytest.raises(NoSpaceError, match=str(tmp_path)), Stage(tmp_path, "work"):
        raise RuntimeError("Can't decrement id ref count")
    with pytest.raises(NoSpaceError), Stage(tmp_path, "work") as stage:
        stage.prove_room()  # after one that only logs it


@pytest.mark.parametrize("at", [1, 4])
@pytest.mark.parametrize("to", ["kitti", "zarr", "monodepth2"])
def test_a_device_that_fills_while_files_are_written(
    to: str,
    at: int,
    run: Callable[..., object],
    tree: Callable[[Path], dict[str, str]],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """Exit code 4, nothing half written under its own name, and the same bytes once there is room."""
    if to == "zarr":
        pytest.importorskip("zarr")
    run(to, "whole", splits=("test",))
    whole, calls = tree(tmp_path / "whole"), iter(range(1, 10_000))
    mkdir = Path.mkdir

    def fills(path: Path, *rest: object, **named: object) -> None:
        if ".export/work/" in str(path) and next(calls) >= at:
            raise FULL
        mkdir(path, *rest, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "mkdir", fills)
    with pytest.raises(NoSpaceError) as caught:
        run(to, splits=("test",))
    monkeypatch.undo()
    assert caught.value.exit_code == 4 and str(caught.value).count("no space left") == 1
    assert not (tmp_path / "out/export.json").exists()
    for name, digest in tree(tmp_path / "out").items():
        assert whole[name] == digest, name
    run(to, splits=("test",))
    assert tree(tmp_path / "out") == whole
