"""Readers of picture formats, written from the formats' own documentation and loaders, not from the exporter."""

from __future__ import annotations

import json
import pickletools
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from consumers.geometry import moved, quaternion_pose
from consumers.seen import Seen

SPLITS = ("train", "val", "test")


def _gain(path: Path) -> dict[str, object]:
    return dict(json.loads(path.read_text()))


def _missing(values: np.ndarray, unit: float) -> np.ndarray:
    """Depth of a 16-bit picture; zero means none."""
    assert values.dtype == np.uint16
    return np.where(values == 0, np.nan, values.astype(np.float64) * unit)


def _drives(root: Path) -> Iterator[Path]:
    for split in SPLITS:
        yield from sorted((root / split).glob("*-*-*"))


def _as_stored(path: Path) -> np.ndarray:
    """For loaders that do not convert what Pillow opens, but index three channels: one of them, as all are equal."""
    image = np.array(Image.open(path))
    assert image.dtype == np.uint8 and image.shape[2:] == (3,), (path, image.shape)
    assert (image == image[..., :1]).all()
    return image[..., 0]


def tartanair(root: Path) -> Iterator[Seen]:
    """Data files as the data cacher parses them; decoders of tartanairpy's page on modalities; NED poses."""
    environments = [
        name for names in json.loads((root / "splits.json").read_text()).values() for name in names
    ]
    files = [path for name in environments for path in sorted((root / name / "analyze").glob("data_*.txt"))]
    trajectories = dict(entry for path in files for entry in _data_file(path))
    assert trajectories == dict(e for split in SPLITS for e in _data_file(root / f"data_{split}.txt"))
    for home, frames in ((root / name, frames) for name, frames in trajectories.items()):
        assert (root / home.parts[-3] / f"analyze/data_{'_'.join(home.parts[-3:])}.txt") in files
        assert frames == [f"{k:06d}" for k in range(len(frames))]
        poses = np.loadtxt(home / "pose_lcam_front.txt")
        assert len(poses) == len(frames)
        K = np.array(json.loads((home / "intrinsics.json").read_text())["K"])
        for k, pose in enumerate(poses):
            name = f"{k:06d}_lcam_front"
            bytes_ = cv2.imread(str(home / f"depth_lcam_front/{name}_depth.png"), cv2.IMREAD_UNCHANGED)
            depth = np.squeeze(bytes_.view("<f4"), axis=-1)
            flow = _tartan_flow(home / f"flow_lcam_front/{k:06d}_{k + 1:06d}_flow.png")
            exact = {"depth": np.where(depth == 1e5, np.float32(np.inf), depth)}
            if (home / "seg_lcam_front").exists():
                exact["semantic"] = cv2.imread(
                    str(home / f"seg_lcam_front/{name}_seg.png"), cv2.IMREAD_UNCHANGED
                )
            yield Seen(
                f"{home.parent.parent.name}-{int(home.name[1:]):03d}-{k:04d}",
                exact=exact,
                flow_px=flow[0] if flow else None,
                flow_seen_px=flow[1] if flow else None,
                grey=cv2.imread(str(home / f"image_lcam_front/{name}.png"))[..., 0],
                gain=_gain(home / "gain.json"),
                pose=_from_ned(pose),
                K=K,
            )


def _data_file(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Trajectories and their frames: a line with both name and number, then as many lines."""
    lines = iter(path.read_text().splitlines())
    for line in lines:
        name, number = line.split(" ")
        yield name, [next(lines) for _ in range(int(number))]


def _tartan_flow(path: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """Flow where it fits, and where the mask says that it is seen."""
    if not path.exists():
        return None
    flow16 = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    flow = (flow16[:, :, :2].astype(np.float64) - 32768) / 64.0
    mask = flow16[:, :, 2].astype(np.uint8)[..., None]
    stored = (flow16[:, :, :2] > 0).any(axis=2, keepdims=True)
    return np.where(stored, flow, np.nan), np.where(mask == 0, flow, np.nan)


def _from_ned(row: np.ndarray) -> np.ndarray:
    """A body (x forward, y right, z down) in a NED world as an OpenCV camera in an ENU world, axis by axis."""
    ned = quaternion_pose(row[:3], row[3:])

    def enu(v: np.ndarray) -> np.ndarray:
        north, east, down = v
        return np.array([east, north, -down])

    pose = np.eye(4)
    for column, axis in enumerate((ned[:3, 1], ned[:3, 2], ned[:3, 0])):  # right, down, forward
        pose[:3, column] = enu(axis)
    pose[:3, 3] = enu(ned[:3, 3])
    return pose


def pix2pix(root: Path, cap_m: float = 100.0) -> Iterator[Seen]:
    """`AlignedDataset`: left half A, right half B, both RGB."""
    for path in sorted(p for split in SPLITS for p in (root / split).glob("*.png")):
        image = Image.open(path).convert("RGB")
        half = image.size[0] // 2
        a, b = (np.array(image.crop((x, 0, x + half, image.size[1])))[..., 0] for x in (0, half))
        gain = _gain(root / f"gain/{path.stem[:-5]}.json")
        yield Seen(path.stem, depth_m=b.astype(np.float64) / 255.0 * cap_m, grey=a, gain=gain)


def ms2(root: Path) -> Iterator[Seen]:
    """`DataLoader_MS2`: lists, calibration, left and right pictures, filtered depth / 256, odometry 4x4."""
    names = [name for split in SPLITS for name in _sequences(root / f"{split}_list.txt")]
    halves = [name for when in ("day", "night") for name in _sequences(root / f"test_{when}_list.txt")]
    assert sorted(_sequences(root / "test_list.txt")) == sorted(halves)
    for name in names:
        _check_harmless(root / "sync_data" / name / "calib.npy")
        calibration = np.load(root / "sync_data" / name / "calib.npy", allow_pickle=True).item()
        baseline = abs(calibration["T_thrR"][0].astype(np.float32)) * 0.001
        assert baseline == 0.0 and np.array_equal(calibration["R_nir2thr"], np.eye(3))
        lefts = sorted((root / "sync_data" / name / "thr/img_left").glob("*.png"))
        rights = sorted((root / "sync_data" / name / "thr/img_right").glob("*.png"))
        assert [p.name for p in lefts] == [p.name for p in rights]
        for left in lefts:
            depth = np.array(
                Image.open(root / "proj_depth" / name / "thr/depth_filtered" / left.name), np.uint16
            )
            pose = np.genfromtxt(root / "odom" / name / "thr" / f"{left.stem}.txt").reshape(4, 4)
            yield Seen(
                f"{name}-{int(left.stem):04d}",
                exact={"thermal": np.array(Image.open(left), np.uint16)},
                depth_m=_missing(depth, 1 / 256),
                pose_from_first=pose,
                K=moved(calibration["K_thrL"], 0.5),
            )


def _check_harmless(path: Path) -> None:
    """The only names in it are two classes of numpy that scanners of pickles let pass."""
    data = path.read_bytes()
    start = 10 + int.from_bytes(data[8:10], "little")
    operations = list(pickletools.genops(data[start:]))
    names = {argument for operation, argument, _ in operations if operation.name in ("GLOBAL", "INST")}
    assert names == {"numpy ndarray", "numpy dtype"}
    assert not any(operation.name in ("STACK_GLOBAL", "EXT1", "EXT2", "EXT4") for operation, *_ in operations)


def _sequences(path: Path) -> list[str]:
    """Every line without its last character, as the loader takes it."""
    with path.open() as file:
        return [line[:-1] for line in file]


def filelist(root: Path, kind: str = "kitti") -> Iterator[Seen]:
    """Depth-Anything-V2's VKITTI2 and KITTI classes and ZoeDepth's `DataLoadPreprocess`, line by line."""
    for split in SPLITS:
        if kind == "zoe":
            lines = (root / f"train_test_inputs/scenegen_{split}_files_with_gt.txt").read_text().splitlines()
        else:
            lines = (root / f"dataset/splits/{kind}/{split}.txt").read_text().splitlines()
        for line in lines:
            image, depth, *focal = line.split(" ")
            values = cv2.imread(str(root / depth), cv2.IMREAD_UNCHANGED)
            far = np.where(values == 65535, np.nan, values / 100.0)
            yield Seen(
                Path(image).stem,
                depth_m=far if kind == "vkitti2" else _missing(values, 1 / 256),
                grey=_as_stored(root / image) if kind == "zoe" else cv2.imread(str(root / image))[..., 2],
                gain=_gain(root / f"gain/{Path(image).parent.name}.json"),
                K=_focal(float(focal[0]), values.shape) if focal else None,
            )


def _focal(focal: float, shape: tuple[int, ...]) -> np.ndarray:
    return np.array([[focal, 0, shape[1] / 2], [0, focal, shape[0] / 2], [0, 0, 1]])
