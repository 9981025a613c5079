"""One flipped bit of what nothing else repeats is found again, wherever it is; anything more is left alone."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from scenegen.foundation.errors import InputError
from scenegen_datasets.repair.clean import clean
from scenegen_datasets.repair.heal import IRREPLACEABLE, heal, unflipped
from scenegen_datasets.repair.repair import repair
from scenegen_datasets.run_log import RunLog
from scenegen_datasets.verify import verify

BYTES = st.binary(min_size=1, max_size=200)


def flipped(data: bytes, bit: int) -> bytes:
    """The same with one bit changed."""
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << (bit % 8)
    return bytes(changed)


@given(BYTES, st.data())
@settings(max_examples=150, deadline=None)
def test_one_bit_is_found_wherever_it_is(data: bytes, draw: st.DataObject) -> None:
    bit = draw.draw(st.integers(0, 8 * len(data) - 1))
    assert unflipped(flipped(data, bit), hashlib.sha256(data).hexdigest()) == data


@given(BYTES, st.data())
@settings(max_examples=60, deadline=None)
def test_two_bits_are_not(data: bytes, draw: st.DataObject) -> None:
    one, two = (draw.draw(st.integers(0, 8 * len(data) - 1)) for _ in range(2))
    assume(one != two)
    assert unflipped(flipped(flipped(data, one), two), hashlib.sha256(data).hexdigest()) is None


@given(BYTES, BYTES)
@settings(max_examples=60, deadline=None)
def test_another_length_is_not(data: bytes, more: bytes) -> None:
    assert unflipped(data + more, hashlib.sha256(data).hexdigest()) is None


@pytest.mark.parametrize("name", ["recipe.yaml", "recipe.lock.json"])
@given(where=st.floats(0, 1, exclude_max=True))
@settings(max_examples=4, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_file_of_a_dataset_heals_and_nothing_else_changes(
    pristine: Path, tmp_path: Path, name: str, where: float
) -> None:
    assert name in IRREPLACEABLE
    shutil.rmtree(tmp_path / "copy", ignore_errors=True)
    root = shutil.copytree(pristine, tmp_path / "copy")
    data = (root / name).read_bytes()
    (root / name).write_bytes(flipped(data, int(where * 8 * len(data))))
    assert heal(root) == (name,)
    assert (root / name).read_bytes() == data and heal(root) == ()
    assert verify(root, quick=True).ok


def test_what_is_damaged_beyond_that_is_left_as_it_is(dataset: Path) -> None:
    path = dataset / "recipe.lock.json"
    hurt = flipped(flipped(path.read_bytes(), 9), 99)
    path.write_bytes(hurt)
    assert heal(dataset) == () and path.read_bytes() == hurt


@pytest.mark.parametrize("left", [None, 0, 300])
def test_a_lock_comes_back_from_the_log_of_a_run(dataset: Path, left: int | None) -> None:
    """Lost, emptied or cut; the newest line that tells the truth wins, and lines of others do no harm."""
    path = dataset / "recipe.lock.json"
    lock = path.read_bytes()
    facts = {"pairs": 1, "missing": 0, "processes": 2, "machine": {"cpus": 2}}
    with RunLog(dataset) as log:
        log.write("start", **facts, **json.loads(lock))
        log.write("start", **facts, **{**json.loads(lock), "git_sha": "of another run"})
        log.write("end", content_id="0")
    with (dataset / "run.log.jsonl").open("a") as file:
        file.write('{"event": "start", "event": [}\n[1]\n{"event": "sta')
    if left is None:
        path.unlink()
    else:
        path.write_bytes(lock[:left])
    assert heal(dataset) == ("recipe.lock.json",)
    assert path.read_bytes() == lock and heal(dataset) == ()


def test_a_log_that_tells_another_lock_is_not_believed(dataset: Path) -> None:
    path = dataset / "recipe.lock.json"
    with RunLog(dataset) as log:
        log.write("start", **{**json.loads(path.read_bytes()), "name": "another"})
    path.unlink()
    assert heal(dataset) == () and not path.exists()


def test_a_large_file_is_not_searched_for_hours(dataset: Path) -> None:
    """The search grows with the square of the size; and a link is not followed into a file that could be hurt."""
    (dataset / "recipe.yaml").write_bytes(b"#" * (1 << 17))
    lock = dataset / "recipe.lock.json"
    lock.replace(dataset / "elsewhere")
    lock.symlink_to(dataset / "elsewhere")
    assert heal(dataset) == ()
    assert lock.is_symlink()


@pytest.mark.parametrize("name", ["index.npy", "README.md"])
def test_a_link_in_the_place_of_a_derived_file_goes_as_verify_says(
    dataset: Path, fakes: ModuleType, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`repair` writes over no link; `clean` removes it, and what it led to stays."""
    monkeypatch.setattr("scenegen_datasets.repair.repair.write_preview", lambda _: None)
    before = fakes.tree(dataset)
    (dataset / name).rename(tmp_path / "outside")
    (dataset / name).symlink_to(tmp_path / "outside")
    assert "`scenegen clean` removes it" in str(verify(dataset).findings)
    with pytest.raises(InputError, match="is a symbolic link"):
        repair(dataset, 1)
    clean(dataset)
    assert repair(dataset, 1).after.ok
    assert fakes.tree(dataset) == before
    assert (tmp_path / "outside").read_bytes() == before[name]
