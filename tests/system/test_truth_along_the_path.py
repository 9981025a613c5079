"""What a dataset says of the way of its camera: poses, times, velocity and inertial samples agree with each other."""

from __future__ import annotations

import io
import json
import tarfile
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import small

from scenegen_cli.main import main
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.verify import verify

LAYERS = ("thermal", "depth", "imu")
G = np.array([0.0, 0.0, -9.80665])


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two clips of four pairs with noisy inertial samples and a still camera."""
    root = tmp_path_factory.mktemp("truth") / "flown"
    more = ("--layers", *LAYERS, "--flight.imu.noise", "on", "--flight.vibration-mrad", "0")
    arguments = small.render(root, pairs=8, jobs=1, more=more)
    assert main(arguments) == 0
    return root


def frames(root: Path, clip: int) -> list[tuple[dict[str, object], np.ndarray]]:
    """JSON and inertial table of every frame of a clip, read with nothing but numpy."""
    with tarfile.open(root / f"shards/train/city-00000/{clip:03d}.tar") as tar:
        names = tar.getnames()
        read = lambda name: tar.extractfile(name).read()  # type: ignore[union-attr]  # noqa: E731
        facts = [json.loads(read(n)) for n in names if n.endswith(".json")]
        tables = [np.load(io.BytesIO(read(n)), allow_pickle=False) for n in names if n.endswith(".imu.npy")]
    return list(zip(facts, tables, strict=True))


def test_it_verifies_and_the_record_tells_the_style(flown: Path) -> None:
    assert verify(flown).ok
    for line in (flown / "clips.jsonl").read_text().splitlines():
        clip = json.loads(line)
        assert sum(clip["extra"]["rejections"].values()) == clip["rejected"]
        first = frames(flown, clip["job"]["clip"])[0][0]
        assert clip["extra"]["style"] == first["style"]
        assert len(clip["extra"]["wind_mps"]) == 2


def test_neighbours_are_where_the_relative_poses_say(flown: Path) -> None:
    for clip in (0, 1):
        told = [facts for facts, _ in frames(flown, clip)]
        for here, after in pairwise(told):
            now, then = (np.array(facts["world_from_camera"]) for facts in (here, after))
            np.testing.assert_allclose(
                np.array(here["next_from_camera"]), np.linalg.inv(then) @ now, atol=1e-9
            )
            np.testing.assert_allclose(
                np.array(after["previous_from_camera"]), np.linalg.inv(now) @ then, atol=1e-9
            )
            assert here["next_time_s"] == after["time_s"]
            assert after["previous_time_s"] == here["time_s"]
            mean = (then[:3, 3] - now[:3, 3]) / (after["time_s"] - here["time_s"])
            between = 0.5 * (np.array(here["velocity_mps"]) + np.array(after["velocity_mps"]))
            np.testing.assert_allclose(mean, between, atol=0.25)


def test_inertial_samples_carry_one_frame_to_the_next(flown: Path) -> None:
    """A strapdown integration from the table alone ends at the pose of the last frame."""
    for clip in (0, 1):
        told = frames(flown, clip)
        table = np.concatenate([rows for _, rows in told])
        np.testing.assert_allclose(np.diff(table[:, 0]), 0.005, atol=1e-9)
        assert table.shape[1] == 13
        record = json.loads((flown / "clips.jsonl").read_text().splitlines()[clip])
        mount = np.array(record["extra"]["body_from_camera"])
        pose = np.array(told[0][0]["world_from_camera"])
        turn, place, speed = pose[:3, :3] @ mount.T, pose[:3, 3], np.array(told[0][0]["velocity_mps"])
        last, dt = told[-1][0], 0.005
        steps = int(last["time_s"] / dt)  # type: ignore[operator]
        for k in range(steps):
            later = turn @ turned(0.5 * (table[k, 4:7] + table[k + 1, 4:7]) * dt)
            pull = 0.5 * (turn @ table[k, 1:4] + later @ table[k + 1, 1:4]) + G
            place, speed, turn = place + speed * dt + 0.5 * pull * dt**2, speed + pull * dt, later
        place = place + speed * (last["time_s"] - steps * dt)  # type: ignore[operator]
        end = np.array(last["world_from_camera"])
        assert np.linalg.norm(place - end[:3, 3]) < 0.02
        assert np.abs(turn @ mount - end[:3, :3]).max() < 0.02


def test_measured_samples_scatter_about_the_ideal_ones(flown: Path) -> None:
    table = np.concatenate([rows for _, rows in frames(flown, 0)])
    error = table[:, 7:] - table[:, 1:7]
    assert (np.abs(error[:, :3].std(axis=0) / (1.7e-3 * np.sqrt(200.0)) - 1.0) < 0.3).all()
    assert (np.abs(error[:, 3:].std(axis=0) / (2.4e-4 * np.sqrt(200.0)) - 1.0) < 0.3).all()


def test_the_loader_gives_the_same_tables(flown: Path) -> None:
    pairs = PairDataset(flown, layers=LAYERS)
    assert pairs[0]["imu"].tobytes() == frames(flown, 0)[1][1].tobytes()


def turned(vector: np.ndarray) -> np.ndarray:
    """Rotation matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / max(angle, 1e-12)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
