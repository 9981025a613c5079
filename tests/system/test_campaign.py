"""Campaigns end to end: one command flies them, the same however it is run, whatever a pilot does."""

import csv
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import small
from PIL import Image

import campaign_pilots
from scenegen_cli.main import main
from scenegen_render.camera import Camera
from scenegen_trainers.pilots.checkpoint import save

TESTS = Path(__file__).parents[1]
FLIGHTS = 8
SMALL = [
    *("--size", "48x27"),
    *("--city.extent-m", "400"),
    *("--mission.distance-m", "45"),
    *("--campaign.flights-per-batch", "4"),
    *("--campaign.batches-per-world", "1"),
    *("--loop.decision-s", "0.4"),
    *("--exposure.directions", "32"),
    *("--exposure.sun-step-min", "120"),
]


def fly(out: Path, *more: str, flights: int = FLIGHTS, jobs: int = 2) -> list[str]:
    return ["fly", "--flights", str(flights), "--out", str(out), "--jobs", str(jobs), *SMALL, *more]


def outcomes(root: Path) -> dict[str, bytes]:
    """Everything in a campaign that outcomes decide."""
    kept = [*root.glob("flights/**/*.json"), *root.glob("*.json"), root / "flights.csv", root / "index.html"]
    return {str(path.relative_to(root)): path.read_bytes() for path in kept}


def rows(root: Path) -> list[dict[str, str]]:
    return list(csv.DictReader((root / "flights.csv").read_text("utf-8").splitlines()))


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Oracle and blind over eight missions in two worlds, by two processes."""
    root = tmp_path_factory.mktemp("campaign") / "c"
    assert main(fly(root, "--versus", "blind")) == 0
    return root


def test_two_pilots_fly_the_same_missions(flown: Path) -> None:
    found = rows(flown)
    assert len(found) == 2 * FLIGHTS
    missions = [
        [
            tuple(row[k] for k in ("flight", "world", "hour", "start_x_m", "goal_y_m"))
            for row in found
            if row["pilot"] == name
        ]
        for name in ("oracle", "blind")
    ]
    assert missions[0] == missions[1]
    assert len(set(missions[0])) == FLIGHTS
    assert {row["world"] for row in found} == {"2", "12"}  # test worlds of the dataset plan
    assert len({row["hour"] for row in found}) == 2
    results = json.loads((flown / "results.json").read_text())
    oracle, blind = results["lines"]
    assert oracle["ends"]["collision"]["count"] < blind["ends"]["collision"]["count"]
    assert {row["hit"] == "" for row in found if row["outcome"] == "collision"} <= {False}
    for world in (2, 12):
        with Image.open(flown / "plans" / f"city-{world:05d}.webp") as plan:
            assert plan.size == (900, 900)


def test_one_process_growth_and_a_kill_give_the_same_outcomes(flown: Path, tmp_path: Path) -> None:
    root = tmp_path / "c"
    job = small.start(fly(root, "--versus", "blind", flights=6, jobs=1))
    assert small.until(lambda: len(list(root.glob("flights/**/*.json"))) >= 3)
    os.killpg(job.pid, signal.SIGKILL)
    job.communicate()
    begun = {path: path.stat().st_mtime_ns for path in root.glob("flights/**/00000.json")}
    assert len(begun) == 2
    assert list(root.glob("flights/**/00001.json"))  # cut short after two of its four flights
    assert main(fly(root, "--versus", "blind", jobs=1)) == 0
    assert outcomes(root) == outcomes(flown)
    assert all(
        path.stat().st_mtime_ns == then for path, then in begun.items()
    )  # what was kept is not flown again


def test_another_recipe_is_refused_and_the_same_one_flies_nothing(
    flown: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = outcomes(flown)
    assert main(fly(flown, "--versus", "blind", "--seed", "1")) == 2
    assert "seed: 0 -> 1" in capsys.readouterr().err.strip().splitlines()[-1]
    assert main([*fly(flown, "--versus", "blind"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["failed"] == {}
    assert outcomes(flown) == before


def test_a_replay_is_the_flight_that_was_flown(flown: Path) -> None:
    assert main(fly(flown, "--replay", "5", jobs=1)) == 0
    (film,) = (flown / "replays").glob("*.webp")
    (flight,) = (row for row in rows(flown) if row["flight"] == "5")
    with Image.open(film) as moving:
        assert 2 <= getattr(moving, "n_frames", 1) <= int(flight["decisions"]) + 1  # equal frames are merged


def test_a_network_sees_heat_and_a_pilot_that_fails_costs_its_flights_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(TESTS)
    network = tmp_path / "warm.pt"
    save(network, campaign_pilots.Warm(), {}, Camera.from_fov(48, 27, 90.0))
    root = tmp_path / "c"
    pilots = ("--pilot", str(network), "--versus", "campaign_pilots:Faulty")
    assert main(fly(root, *pilots, flights=4, jobs=1)) == 0
    reasons = {
        (row["pilot"], int(row["flight"])): row["reason"] for row in rows(root) if row["outcome"] == "pilot"
    }
    assert sorted(reasons) == [("Faulty", 1), ("Faulty", 2), ("Faulty", 3)]
    assert reasons["Faulty", 1] == "raised ZeroDivisionError: divided by zero & lost"
    assert "velocity_mps" in reasons["Faulty", 2]
    assert "yaw_rad" in reasons["Faulty", 3]
    assert {row["pilot"] for row in rows(root)} == {"warm", "Faulty"}
    assert "pilot failed" in capsys.readouterr().out


def test_a_pilot_that_takes_its_process_down_costs_its_flights_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(TESTS)
    root = tmp_path / "c"
    pilots = ("--pilot", "crashing_pilot:Crashing", "--versus", "blind")
    assert main(fly(root, *pilots, flights=4, jobs=1)) == 0
    crashing, blind = ([row for row in rows(root) if row["pilot"] == name] for name in ("Crashing", "blind"))
    assert [row["outcome"] == "pilot" for row in crashing] == [False, False, True, False]
    assert "killed by SIGSEGV" in crashing[2]["reason"]
    assert [crashing[k]["outcome"] for k in (0, 1, 3)] == [blind[k]["outcome"] for k in (0, 1, 3)]
    events = [json.loads(line) for line in (root / "run.log.jsonl").read_text("utf-8").splitlines()]
    strikes = [event for event in events if event["event"] == "strike"]
    assert len(strikes) == 3 and all(event["died"] and not event["boxed"] for event in strikes)


def test_a_sweep_flies_every_value_and_draws_it(tmp_path: Path) -> None:
    root = tmp_path / "c"
    assert main(fly(root, "--pilot", "blind", "--sweep", "speed=3,9", "hour=4", flights=4, jobs=1)) == 0
    found = rows(root)
    assert {row["point"] for row in found} == {"speed=3", "speed=9", "hour=4"}
    speed = {
        p: max(float(r["mean_speed_mps"]) for r in found if r["point"] == p) for p in ("speed=3", "speed=9")
    }
    assert speed["speed=3"] < 3.5 < speed["speed=9"]
    assert {row["hour"] for row in found if row["point"] == "hour=4"} == {"4.0"}
    page = (root / "index.html").read_text("utf-8")
    assert [f'aria-label="{words}"' in page for words in ("cruise speed [m/s]", "hour [h]")] == [True, True]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--pilot", "orakle"], "perhaps you meant 'oracle'"),
        (["--planner", "waypont"], "perhaps you meant 'waypoint'"),
        (["--versus", "oracle"], "is the pilot itself"),
        (["--flights", "0"], "--flights 0"),
        (["--latency", "soon"], "--latency soon"),
        (["--speed", "40"], "--speed: loop.cruise_mps"),
        (["--hours", "24"], "hours"),
        (["--replay", "7"], "flights 0 to 3"),
        (["--sweep", "sped=3"], "perhaps you meant 'speed'"),
        (["--mission.dificulty", "0.5"], "perhaps you meant 'difficulty'"),
        (["--map", "cty"], "perhaps you meant 'city'"),
        (["--out", "/dev/null"], "/dev/null"),
        (["--pilott", "oracle"], "perhaps you meant '--pilot'"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["fly", "--flights", "4", "--out", "c", *arguments]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()[-1:]
    assert said in line
    assert line.startswith("scenegen: ")
    assert not list(tmp_path.glob("c/flights"))


def test_the_command_costs_no_torch(tmp_path: Path) -> None:
    code = (
        "import sys; from scenegen_cli.main import main; "
        "main(['fly', '--flights', '4', '--dry-run']); "
        "assert not {'torch', 'mitsuba', 'onnxruntime', 'pyarrow'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=tmp_path, stdout=subprocess.DEVNULL)
