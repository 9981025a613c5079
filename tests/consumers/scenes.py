"""Readers of scene formats: nerfstudio, COLMAP, TUM RGB-D."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from consumers.geometry import moved, quaternion_pose
from consumers.pictures import _as_stored, _drives, _gain
from consumers.seen import Seen


def nerfstudio(root: Path) -> Iterator[Seen]:
    """`Nerfstudio` data parser and `get_depth_image_from_path` with the default scale of 0.001."""
    for home in _drives(root):
        meta = json.loads((home / "transforms.json").read_text())
        K = np.array([[meta["fl_x"], 0, meta["cx"]], [0, meta["fl_y"], meta["cy"]], [0, 0, 1]])
        for k, frame in enumerate(sorted(meta["frames"], key=lambda f: f["file_path"])):
            depth = np.load(home / frame["depth_file_path"]) * 1e-3
            assert depth.shape == (meta["h"], meta["w"])
            pose = np.array(frame["transform_matrix"])
            pose[:, 1:3] *= -1  # OpenGL to OpenCV
            yield Seen(
                f"{home.name}-{k:04d}",
                depth_m=np.where(depth == 0, np.nan, depth.astype(np.float64)),
                grey=_as_stored(home / frame["file_path"]),
                gain=_gain(home / "gain.json"),
                pose=pose,
                K=K,
                time_s=frame["time"],
            )


def colmap(root: Path) -> Iterator[Seen]:
    """Text model and array files after COLMAP's page on formats; every point must project to where it was seen."""
    for home in _drives(root):
        model = home / "sparse/0"
        number, kind, width, height, *parameters = _data(model / "cameras.txt")[0].split()
        assert (number, kind) == ("1", "PINHOLE")
        fx, fy, cx, cy = map(float, parameters)
        K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        points = {int(row.split()[0]): row.split() for row in _data(model / "points3D.txt")}
        lines = [line for line in (model / "images.txt").read_text().split("\n") if not line.startswith("#")]
        tracked = 0
        for head, tail in zip(lines[0:-1:2], lines[1::2], strict=True):
            image_id, *numbers, camera, name = head.split()
            assert camera == "1"
            qw, qx, qy, qz, *place = map(float, numbers)
            camera_from_world = quaternion_pose(np.array(place), np.array([qx, qy, qz, qw]))
            grey = _as_stored(home / "images" / name)  # gsplat and 3D Gaussian splatting do not convert
            tracked += _check_points(tail, points, camera_from_world, K, int(image_id), grey)
            depth = _array_file(home / f"stereo/depth_maps/{name}.geometric.bin")
            assert depth.shape == (int(height), int(width))
            yield Seen(
                f"{home.name}-{int(image_id) - 1:04d}",
                exact={"depth": np.where(depth == 0, np.float32(np.inf), depth)},
                grey=grey,
                gain=_gain(home / "gain.json"),
                pose=np.linalg.inv(camera_from_world),
                K=K,
            )
        assert tracked == len(points)


def _data(path: Path) -> list[str]:
    return [line for line in path.read_text().splitlines() if line and not line.startswith("#")]


def _check_points(
    tail: str, points: dict[int, list[str]], pose: np.ndarray, K: np.ndarray, image: int, grey: np.ndarray
) -> int:
    """Reproject every point of one image; returns how many there are."""
    triples = np.array(tail.split(), float).reshape(-1, 3)
    for index, (u, v, identifier) in enumerate(triples):
        _, x, y, z, r, g, b, error, *track = points[int(identifier)]
        seen = K @ (pose @ [float(x), float(y), float(z), 1.0])[:3]
        assert np.allclose(seen[:2] / seen[2], (u, v), atol=1e-4)
        assert (int(track[0]), int(track[1])) == (image, index) and error == "0"
        assert int(r) == int(g) == int(b) == grey[int(v), int(u)]
    return len(triples)


def _array_file(path: Path) -> np.ndarray:
    data = path.read_bytes()
    width, height, channels, values = data.split(b"&", 3)
    assert channels == b"1"
    return np.frombuffer(values, "<f4").reshape(int(height), int(width))


def tum(root: Path, unit_m: float = 1 / 5000) -> Iterator[Seen]:
    """`read_file_list` and `associate` of the benchmark's tools: the lists must match by time."""
    for home in _drives(root):
        lists = [_list(home / name) for name in ("rgb.txt", "depth.txt", "groundtruth.txt")]
        assert lists[0].keys() == lists[1].keys() == lists[2].keys()
        settings = cv2.FileStorage(str(home / "camera.yaml"), cv2.FILE_STORAGE_READ)
        fx, fy, cx, cy = (settings.getNode(f"Camera.{name}").real() for name in ("fx", "fy", "cx", "cy"))
        assert settings.getNode("DepthMapFactor").real() == 1 / unit_m
        for k, time in enumerate(sorted(lists[0])):
            values = cv2.imread(str(home / lists[1][time][0]), cv2.IMREAD_UNCHANGED)
            pose = np.array(lists[2][time], float)
            yield Seen(
                f"{home.name}-{k:04d}",
                depth_m=np.where(values == 0, np.nan, values / (1 / unit_m)),
                grey=_as_stored(home / lists[0][time][0]),  # `generate_pointcloud` refuses other modes
                gain=_gain(home / "gain.json"),
                pose=quaternion_pose(pose[:3], pose[3:]),
                K=moved(np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]), 0.5),
                time_s=time,
            )


def _list(path: Path) -> dict[float, list[str]]:
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    return {float(row[0]): row[1:] for row in rows}
