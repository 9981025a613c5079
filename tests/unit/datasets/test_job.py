"""What a job knows before anything is made."""

from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError, NoSpaceError
from scenegen_datasets.recipe import resolve_recipe
from scenegen_datasets.render_job import Job, prepare


def job(root: Path, pairs: int = 128) -> Job:
    return Job(recipe=resolve_recipe([]), pairs=pairs, root=root, asked={}, processes=1)


@pytest.mark.parametrize(
    ("directory", "name"),
    [
        ("city-8000", "city-8000"),
        ("My Data.v2", "my-data.v2"),
        ("night\nfall", "night-fall"),
        ("☃", "dataset"),
        ("x" * 200, "x" * 64),
    ],
)
def test_the_name_is_one_every_tool_takes(directory: str, name: str) -> None:
    assert job(Path("/tmp") / directory).name == name


def test_the_size_is_estimated_from_frames_and_pixels() -> None:
    small, large = job(Path("a")), job(Path("a"), 1280)
    assert large.bytes == 10 * small.bytes
    assert 0.9e6 < small.bytes / 130 < 1.5e6  # a frame of 256x256 with all default layers


def test_the_directory_is_made_with_its_parents(tmp_path: Path) -> None:
    prepare(job(tmp_path / "a" / "b c" / "ü"))
    assert (tmp_path / "a" / "b c" / "ü").is_dir()


def test_what_does_not_fit_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Usage:
        total, free = 10**9, 10**6

    monkeypatch.setattr("scenegen_datasets.place.shutil.disk_usage", lambda _: Usage)
    with pytest.raises(NoSpaceError, match=r"about 1\d\d\.\d MB are needed and 1\.0 MB are free"):
        prepare(job(tmp_path / "new"))
    assert not (tmp_path / "new").exists()


def test_a_directory_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="not empty and not a dataset"):
        prepare(job(tmp_path))
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]
