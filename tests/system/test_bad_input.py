"""Every mistake a user can make on the command line: one line, exit code 2, nothing written, no renderer started."""

import os
from pathlib import Path

import pytest

from scenegen_cli.main import main

YAML = {
    "list.yaml": "- 1\n- 2\n",
    "text.yaml": "just words\n",
    "broken.yaml": "a: [1\n",
    "alias.yaml": "camera: &c {width_px: 64}\nsensor: *c\n",
    "twice.yaml": "seed: 1\nseed: 2\n",
    "key.yaml": "sensor: {netdmk: 3}\n",
    "nan.yaml": "sensor: {netd_mk: .nan}\n",
    "inf.yaml": "flight: {spacing_m: .inf}\n",
    "hour.yaml": "climate: {hour: 25}\n",
    "text_number.yaml": "sensor: {netd_mk: '50'}\n",
    "bool_number.yaml": "seed: true\n",
    "section.yaml": "camera: 5\n",
    "pairs.yaml": "pairs: 8\n",
}

CASES = [
    (["render", "--map", "citty"], "unknown map 'citty'; perhaps you meant 'city'"),
    (["render", "--map", "city", "city"], "names a map twice"),
    (["render", "--pairs", "0"], "--pairs is missing or 0"),
    (["render", "--pairs", "-8"], "ask for 1 to 100,000,000"),
    (["render", "--pairs", "1000000000"], "ask for 1 to 100,000,000"),
    (["render", "--pairs", "many"], "is not a whole number"),
    (["render", "--pairs", "nan"], "is not a whole number"),
    (["render", "--pears", "8"], "unknown flag '--pears'; perhaps you meant '--pairs'"),
    (["render", "extra"], "one word too many"),
    (["render", "--size", "5x5"], "must be greater than or equal to 16, not 5"),
    (["render", "--size", "100000x100000"], "must be less than or equal to 4096"),
    (["render", "--size", "big"], "write WIDTHxHEIGHT"),
    (["render", "--size", "-64x64"], "write WIDTHxHEIGHT"),
    (["render", "--jobs", "-1"], "ask for 1 to 1024 processes"),
    (["render", "--seed", "-1"], "--seed: must be greater than or equal to 0"),
    (["render", "--seed", "1.5"], "--seed: must be a whole number, not 1.5"),
    (["render", "--seed", "1", "--seed", "2"], "--seed: must be a whole number, not several values"),
    (["render", "--camera.netdmk", "3"], "--camera.netdmk: unknown key; perhaps you meant 'sensor.netd_mk'"),
    (["render", "--camera.preset", "boson64"], "unknown camera 'boson64'; perhaps you meant 'boson640'"),
    (["render", "--climate.hour", "25"], "--climate.hour: hour must be at least 0 and below 24 h"),
    (["render", "--climate.hour", "20", "3"], "upside down"),
    (["render", "--sensor.netd-mk", ".nan"], "--sensor.netd_mk: must be a finite number"),
    (["render", "--sensor.netd-mk", "1e999"], "--sensor.netd_mk: must be a finite number"),
    (["render", "--sensor.netd-mk", "[1"], "is not a value"),
    (["render", "--sensor.netd-mk"], "a value is missing"),
    (["render", "--sensor.linear-in", "radiants"], "perhaps you meant 'radiance'"),
    (["render", "--layers", "thermal", "deepth"], "unknown layer 'deepth'; perhaps you meant 'depth'"),
    (["render", "--layers", "thermal"], "a pair needs at least 'thermal' and 'depth'"),
    (["render", "--recipe", "nowhere.yaml"], "nowhere.yaml: does not exist"),
    (["render", "--recipe", "."], "is a directory"),
    (["render", "--recipe", "list.yaml"], "list.yaml:1: a recipe is a mapping"),
    (["render", "--recipe", "text.yaml"], "text.yaml:1: a recipe is a mapping"),
    (["render", "--recipe", "broken.yaml"], "broken.yaml:2: is not YAML"),
    (["render", "--recipe", "alias.yaml"], "alias.yaml:1: anchor '&c'"),
    (["render", "--recipe", "twice.yaml"], "twice.yaml:2: duplicate key 'seed'"),
    (["render", "--recipe", "key.yaml"], "key.yaml: sensor.netdmk: unknown key; perhaps you meant 'netd_mk'"),
    (["render", "--recipe", "nan.yaml"], "nan.yaml: sensor.netd_mk: must be a finite number"),
    (["render", "--recipe", "inf.yaml"], "inf.yaml: flight.spacing_m: must be a finite number"),
    (["render", "--recipe", "hour.yaml"], "hour.yaml: climate.hour: hour must be"),
    (["render", "--recipe", "text_number.yaml"], "sensor.netd_mk: expected a number, not '50'"),
    (["render", "--recipe", "bool_number.yaml"], "seed: expected a number, not True"),
    (["render", "--recipe", "section.yaml"], "section.yaml: camera: has keys of its own"),
    (["render", "--recipe", "pairs.yaml"], "pairs.yaml: pairs: unknown key"),
    (["render", "--out", "list.yaml"], "is a file; name a directory"),
    (["render", "--out", "list.yaml/below"], "is a file; name a directory"),
    (["render", "--out", "/proc/nothing"], "/proc"),
    (["render", "--out", "full"], "is not empty and not a dataset"),
    (["render", "--out", "x" * 300], "cannot be"),
    (["info", "nowhere"], "no dataset at nowhere"),
    (["status", "nowhere"], "no dataset at nowhere"),
    (["verify", "nowhere"], "no dataset at nowhere"),
    (["preview", "nowhere"], "no dataset at nowhere"),
    (["verify"], "DATASET is missing"),
    (["verify", "--jsn", "nowhere"], "unknown flag '--jsn'; perhaps you meant '--json'"),
    (["table1", "--data", "nowhere"], "no dataset at nowhere"),
    (["rendr"], "unknown command 'rendr'; perhaps you meant 'render'"),
]


@pytest.mark.parametrize(
    ("arguments", "message"), CASES, ids=lambda v: " ".join(v)[:40] if isinstance(v, list) else ""
)
def test_one_line_and_nothing_written(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in YAML.items():
        Path(name).write_text(text, encoding="utf-8")
    Path("full").mkdir()
    Path("full/precious.txt").write_text("mine", encoding="utf-8")
    if arguments[0] == "render" and "--pairs" not in arguments and "--pears" not in arguments:
        arguments = [*arguments, "--pairs", "8"]
    before = sorted(Path().rglob("*"))
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1, captured.err
    assert message in captured.err
    assert captured.out == ""
    assert sorted(Path().rglob("*")) == before


def test_a_full_device_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    usage = os.statvfs(tmp_path)
    pairs = usage.f_frsize * usage.f_bavail // (64 * 64 * 8)  # more than fits, whatever the disk
    arguments = ["render", "--pairs", str(min(pairs, 100_000_000)), "--size", "4096x4096"]
    assert main([*arguments, "--out", str(tmp_path / "big")]) == 4
    assert "B are needed and " in capsys.readouterr().err
    assert not (tmp_path / "big").exists()


def test_a_dry_run_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "--pairs", "8000", "--dry-run", "--out", str(tmp_path / "ds")]) == 0
    assert "8,000 pairs of 256x256 in 125 clips from 16 worlds" in capsys.readouterr().out
    assert not (tmp_path / "ds").exists()
