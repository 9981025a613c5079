"""Recorded flights: three formats, one path; and one clear line for whatever is wrong with a file."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from scenegen.foundation.errors import InputError, RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.quadrotor.mount import body_from_camera
from scenegen_flythrough.recordings.read import identity, recording_of

STEP_S, END_S = 0.05, 14.0


def loop(t: np.ndarray) -> np.ndarray:
    """A climbing bend at some 8 m/s, 75 to 80 m up: above all roofs of the box city."""
    return np.stack([60.0 * np.sin(t / 8.0), -60.0 * np.cos(t / 8.0), 75.0 + 0.3 * t], axis=1)


def turned(t: np.ndarray) -> Rotation:
    """Nose along the bend, rolled by 5 deg, nodding slowly by up to 4 deg; nose, left, up to the world."""
    yaw, pitch, roll = np.degrees(t / 8.0), 4.0 * np.sin(0.7 * t), np.full_like(t, 5.0)
    return Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], axis=1), degrees=True)


def times() -> np.ndarray:
    return np.arange(0.0, END_S, STEP_S)


def aimed(t: np.ndarray) -> Rotation:
    """A camera on a gimbal that looks 50 deg down from that nose: right, down, ahead to the world."""
    return Rotation.from_matrix(turned(t).as_matrix() @ body_from_camera(-50.0))


def write_csv(path: Path, *, attitude: bool = True, place=loop, facing=turned) -> Path:
    t = times()
    columns = [t + 1700.0, place(t), *([facing(t).as_quat()] if attitude else [])]
    header = "time_s,x,y,z" + (",qx,qy,qz,qw" if attitude else "")
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    return path


def write_tum(path: Path) -> Path:
    t = times()
    np.savetxt(path, np.column_stack([t + 1700.0, loop(t), turned(t).as_quat()]), header="timestamp x y z q")
    return path


def knobs(path: Path, **wishes: object) -> FlightKnobs:
    recorded = {"file": str(path), **wishes.pop("recorded", {})}  # type: ignore[dict-item]
    return FlightKnobs.model_validate(
        {"styles": "recorded", "recorded": recorded, "vibration_mrad": 0, **wishes}
    )


@pytest.fixture
def ulog(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A log as pyulog hands it over: north, east, down; front, right, down; microseconds; scalar first."""
    t = times()
    east, north, up = loop(t).T
    enu_from_ned = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    matrices = enu_from_ned.T @ turned(t).as_matrix() @ np.diag([1.0, -1.0, -1.0])
    x, y, z, w = Rotation.from_matrix(matrices).as_quat().T
    stamps = ((t + 5.0) * 1e6).astype(np.uint64)
    position = {"timestamp": stamps, "x": north, "y": east, "z": -up}
    attitude = {"timestamp": stamps, "q[0]": w, "q[1]": x, "q[2]": y, "q[3]": z}
    topics = {"vehicle_local_position": position, "vehicle_attitude": attitude}

    def read(path: str, wanted: list[str]) -> SimpleNamespace:
        if not Path(path).read_bytes().startswith(b"ULog"):
            raise TypeError("Invalid file format")
        data = [SimpleNamespace(name=n, multi_id=0, data=topics[n]) for n in wanted]
        return SimpleNamespace(data_list=data)

    module = ModuleType("pyulog")
    module.ULog = read  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyulog", module)
    path = tmp_path / "log.ulg"
    path.write_bytes(b"ULog")
    return path


def test_all_formats_give_the_same_recording(ulog: Path, tmp_path: Path) -> None:
    read = [
        recording_of(str(path), identity(str(path)))
        for path in (write_csv(tmp_path / "a.csv"), write_tum(tmp_path / "a.tum"), ulog)
    ]
    for recording in read:
        np.testing.assert_allclose(recording.time_s, times(), atol=1e-6)
        np.testing.assert_allclose(recording.place, loop(times()), atol=1e-9)
        assert recording.quaternion is not None
        error = Rotation.from_quat(recording.quaternion) * turned(times()).inv()
        assert error.magnitude().max() < 1e-7


@pytest.mark.parametrize("camera", [False, True])
def test_a_recording_is_flown_where_and_as_it_was(
    city, city_air: Airspace, tmp_path: Path, camera: bool
) -> None:
    path = write_csv(tmp_path / "a.csv", facing=aimed if camera else turned)
    wish = knobs(
        path, recorded={"camera": camera}, pitch_deg=-10.0, height_m=(4, 120), limits={"yaw_rate_dps": 90}
    )
    trajectory = fly(city.world, wish, 65, stream(1, "recorded"), city_air)
    place = trajectory.world_from_camera[:, :3, 3]
    start = float(np.arctan2(place[0, 0], -place[0, 1]) * 8.0)
    t = start + trajectory.time_s - trajectory.time_s[0]
    np.testing.assert_allclose(place, loop(t), atol=0.02)
    # What the file calls an orientation is the camera's, or the airframe's that carries it.
    attitude = aimed(t).as_matrix() if camera else turned(t).as_matrix() @ trajectory.body_from_camera
    error = (
        Rotation.from_matrix(trajectory.world_from_camera[:, :3, :3]) * Rotation.from_matrix(attitude).inv()
    )
    assert np.degrees(error.magnitude().max()) < 0.3
    assert trajectory.style == "recorded"
    assert trajectory.clearance_m >= 1.0
    rates = np.linalg.norm(trajectory.imu.rates_radps, axis=1)
    assert 0.1 < rates.mean() < 0.25  # 1/8 rad/s of yaw, and the nodding


def test_body_rates_of_a_recording_are_those_of_its_turning(city, city_air: Airspace, tmp_path: Path) -> None:
    wish = knobs(write_csv(tmp_path / "a.csv"), height_m=(4, 120))
    trajectory = fly(city.world, wish, 65, stream(1, "recorded"), city_air)
    t, h = np.linspace(0.1, 6.0, 50) + trajectory.zero_s, 1e-4
    before, now, after = (trajectory.motion.attitude(t + d).world_from_body for d in (-h, 0.0, h))
    turning = np.einsum("nji,njk->nik", now, (after - before) / (2 * h))
    rates = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
    np.testing.assert_allclose(trajectory.motion.attitude(t).rates_radps, rates, atol=1e-5)


def test_without_orientations_it_leans_like_a_quadrotor(city, city_air: Airspace, tmp_path: Path) -> None:
    wish = knobs(write_csv(tmp_path / "a.csv", attitude=False), pitch_deg=0.0, height_m=(4, 120))
    trajectory = fly(city.world, wish, 65, stream(1, "recorded"), city_air)
    speed = np.linalg.norm(trajectory.velocity_mps, axis=1)
    nose = np.degrees(np.arcsin(trajectory.world_from_camera[:, 2, 2]))
    np.testing.assert_allclose(nose[5:-5], -np.degrees(np.arctan(0.25 * speed / 9.80665))[5:-5], atol=2.0)


def test_anywhere_moves_and_turns_the_recording(city, city_air: Airspace, tmp_path: Path) -> None:
    wish = knobs(write_csv(tmp_path / "a.csv"), recorded={"place": "anywhere"}, height_m=(15, 90))
    made = [fly(city.world, wish, 33, stream(2, k), city_air) for k in range(6)]
    starts = np.array([t.world_from_camera[0, :3, 3] for t in made])
    assert np.ptp(starts[:, :2], axis=0).min() > 40.0
    assert np.ptp(starts[:, 2]) > 10.0
    for trajectory in made:
        speed = np.linalg.norm(trajectory.velocity_mps, axis=1)
        np.testing.assert_allclose(speed, np.hypot(7.5, 0.3), rtol=0.02)
        course = np.unwrap(np.arctan2(*trajectory.velocity_mps.T[1::-1]))
        assert np.ptp(course) == pytest.approx(np.ptp(trajectory.time_s) / 8.0, rel=0.05)


def test_the_recipe_knows_the_content_and_refuses_another(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "a.csv")
    first = knobs(path)
    assert len(first.recorded.sha256) == 64
    assert FlightKnobs.model_validate(first.model_dump()) == first
    write_csv(path, attitude=False)
    with pytest.raises(ValidationError, match="not the recording this recipe was made with"):
        FlightKnobs.model_validate(first.model_dump())


ROWS = "".join(f"{0.1 * k},{k},0,70\n" for k in range(40))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", None, "no such file"),
        ("a.mov", "x", "ends in .csv"),
        ("a.csv", "", "must name the columns"),
        ("a.csv", "t,x,y\n1,2,3\n", "must name the columns"),
        ("a.csv", "time_s,x,y,z,qx\n" + ROWS, "all of qx, qy, qz, qw"),
        ("a.csv", "time_s,x,y,z\n0,1,2,3\n", "1 poses are too few"),
        (
            "a.csv",
            "time_s,x,y,z\n" + ROWS + "4.0,41,0,nan\n",
            "pose 41 holds something that is no finite number",
        ),
        ("a.csv", "time_s,x,y,z\n" + ROWS + "4.0,forty,0,70\n", "line 42: 'forty' is not a number"),
        ("a.csv", "time_s,x,y,z\n" + ROWS + "4.0,41\n", "line 42: '' is not a number"),
        ("a.csv", "time_s,x,y,z\n" + ROWS + "3.0,41,0,70\n", "time does not rise after pose 40"),
        ("a.csv", "time_s,x,y,z\n" + ROWS + "9.0,41,0,70\n", "nothing for 5.1 s after pose 40"),
        ("a.csv", "time_s,x,y,z\n" + ROWS + "4.0,4e6,0,70\n", "use metres"),
        ("a.csv", "time_s,x,y,z\n" + "".join(f"{k},1,2,3\n" for k in range(9)), "nothing moves"),
        ("a.tum", "0 1 2 3\n", "line 1 has 4 numbers, not 8"),
        ("a.tum", "".join(f"{k} {k} 0 70 0 0 0 2\n" for k in range(9)), "pose 1 has length 2, not 1"),
        ("a.csv", b"\xff\xfe\x00", "is not a text file"),
    ],
)
def test_a_bad_file_is_one_clear_line(
    tmp_path: Path, name: str, content: str | bytes | None, message: str
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as told:
        identity(str(path))
    assert message in str(told.value)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)
    with pytest.raises(ValidationError):
        knobs(path)


def test_a_log_that_cannot_be_read_says_why(ulog: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ulog.write_bytes(b"nonsense")
    with pytest.raises(InputError, match="not a ULog file"):
        identity(str(ulog))
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(InputError, match=r"pip install 'thermal-scenegen\[ulog\]'"):
        identity(str(ulog))


def test_a_recording_that_does_not_fit_says_why(city, city_air: Airspace, tmp_path: Path) -> None:
    path = write_csv(tmp_path / "short.csv")
    with pytest.raises(InputError, match=r"short.csv: 10\d\.\d m long, but 200 frames 1 m apart take 201 m"):
        fly(city.world, knobs(path), 200, stream(1), city_air)
    cases = {
        "away": (lambda t: loop(t) + np.array([500.0, 0.0, 0.0]), "left the flight box"),
        "low": (
            lambda t: loop(t) - np.array([0.0, 0.0, 76.0]),
            "came closer than clearance_m|left the flight box",
        ),
        "wild": (lambda t: loop(t) + 2.0 * np.sin(6.0 * t)[:, None], "more than the drone's limits"),
    }
    for name, (place, message) in cases.items():
        bad = write_csv(tmp_path / f"{name}.csv", place=place)
        with pytest.raises(RejectedDrawError, match=message) as told:
            fly(city.world, knobs(bad, max_draws=40), 33, stream(1), city_air)
        assert f"{name}.csv: no stretch of 34 m" in str(told.value)
