"""Every format, read back by its consumer's rules: what arrives is what was there, within the documented loss."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from consumers import CONSUMERS, check
from consumers.pictures import ms2, pix2pix
from consumers.scenes import tum
from consumers.seen import Original, Rule, compare
from scenegen.foundation.errors import InputError
from scenegen_datasets.exports.formats.ms2 import PLANCK_B, PLANCK_F, PLANCK_O, PLANCK_R
from scenegen_datasets.exports.registry import FORMATS

PAIRS = 18
"""Of the small dataset: six clips of three."""


def test_every_format_has_a_consumer() -> None:
    assert list(FORMATS) == list(CONSUMERS)


@pytest.mark.parametrize("name", FORMATS)
def test_consumer_sees_the_dataset(
    name: str, run: Callable[..., object], small: Path, tmp_path: Path
) -> None:
    for module in FORMATS[name].modules:
        pytest.importorskip(module)
    if name == "hf":
        pytest.importorskip("datasets.arrow_dataset")
    run(name)
    compared, errors = check(name, tmp_path / "out", small)
    inner = 12 if name == "monodepth2" else PAIRS
    assert compared == inner * len(CONSUMERS[name])
    assert errors, "a reader that compares nothing proves nothing"


@pytest.fixture(scope="module")
def two_cameras(make_dataset: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As parts of a merged dataset may have them."""
    return make_dataset(tmp_path_factory.mktemp("cameras") / "dataset", cameras=2)


@pytest.mark.parametrize(
    "name", ["kitti", "tartanair", "ms2", "filelist", "nerfstudio", "colmap", "tum", "hf"]
)
def test_each_clip_keeps_its_camera(
    name: str, run: Callable[..., object], two_cameras: Path, tmp_path: Path
) -> None:
    if name == "hf":
        pytest.importorskip("datasets.arrow_dataset")
    run(name, dataset=two_cameras)
    check(name, tmp_path / "out", two_cameras)


def test_a_format_of_one_camera_refuses_a_second(
    run: Callable[..., object], two_cameras: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"holds one camera, and \S+ and \S+ differ in K; export them apart"):
        run("monodepth2", dataset=two_cameras)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", [n for n, each in FORMATS.items() if n != "rerun"])
def test_same_bytes_twice(
    name: str, run: Callable[..., object], tree: Callable[..., dict[str, str]], tmp_path: Path
) -> None:
    for module in FORMATS[name].modules:
        pytest.importorskip(module)
    run(name, "one", splits=("val",))
    run(name, "two", splits=("val",))
    assert tree(tmp_path / "one") == tree(tmp_path / "two")


def test_pix2pix_with_another_cap(run: Callable[..., object], small: Path, tmp_path: Path) -> None:
    run("pix2pix", depth_cap_m=40.0)
    original = Original(small)
    rule = Rule(depth_step_m=40 / 255, depth_most_m=40.0, depth_capped=True)
    for seen in pix2pix(tmp_path / "out", cap_m=40.0):
        compare(seen, original.pair(seen.key), rule)


def test_tum_with_another_unit(run: Callable[..., object], small: Path, tmp_path: Path) -> None:
    far = run("tum", "millimetres").counts["depth_too_far"]  # type: ignore[attr-defined]
    assert run("tum", depth_unit_m=0.01).counts["depth_too_far"] == 0 < far  # type: ignore[attr-defined]
    original = Original(small)
    for seen in tum(tmp_path / "out", unit_m=0.01):
        if not seen.key.endswith("-0000"):
            compare(seen, original.pair(seen.key), Rule(depth_step_m=0.01, depth_most_m=655.35, time_s=1e-6))


def test_ms2_in_counts_of_its_own_camera(run: Callable[..., object], small: Path, tmp_path: Path) -> None:
    """MS2's `Raw2Celsius` on the exported counts gives the brightness temperature of ours."""
    run("ms2", encoding="a65c")
    original, compared = Original(small), 0
    for seen in ms2(tmp_path / "out"):
        if seen.key.endswith("-0000"):
            continue
        raw = seen.exact["thermal"].astype(np.float64)
        kelvin = PLANCK_B / np.log(PLANCK_R / (raw - PLANCK_O) + PLANCK_F)
        wanted = original.pair(seen.key)["brightness_K"]
        step = PLANCK_B / np.log(PLANCK_R / (raw + 1 - PLANCK_O) + PLANCK_F) - kelvin
        fits = wanted < 400.0  # where the A65C's 14 bits do not end
        assert (np.abs(kelvin - wanted)[fits] <= 0.51 * step[fits]).all()
        compared += int(fits.sum())
    assert compared > 1000


@pytest.mark.parametrize("gain", ["ground", "fixed"])
def test_other_gains_turn_back(gain: str, run: Callable[..., object], small: Path, tmp_path: Path) -> None:
    options = {"gain": gain, **({"gain_K": (260.0, 330.0)} if gain == "fixed" else {})}
    outcome = run("pix2pix", **options)
    compared, errors = check("pix2pix", tmp_path / "out", small)
    assert compared == PAIRS and 0.0 < errors["grey"] <= 0.5 + 1e-6
    assert outcome.counts["thermal_clipped"] > 0  # type: ignore[attr-defined]
