"""Readers of KITTI's layouts: the benchmarks for odometry, depth and flow, and monodepth2's drives."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from consumers.geometry import moved
from consumers.pictures import SPLITS, _gain, _missing
from consumers.seen import Seen


def kitti(root: Path) -> Iterator[Seen]:
    """Sequences as `pykitti.odometry` finds them; depth and flow as development kits and RAFT's `KITTI` read them."""
    for split in SPLITS:
        flows = _kitti_flows(root / split / "KittiFlow" / "training")
        for home in sorted((root / split / "sequences").glob("*")):
            poses = np.loadtxt(root / split / f"poses/{home.name}.txt").reshape(-1, 3, 4)
            times = np.loadtxt(home / "times.txt")
            lines = (home / "calib.txt").read_text().splitlines()
            calibration = {
                name: np.array(row.split(), float) for name, row in (x.split(":", 1) for x in lines)
            }
            P0, P2, _ = (calibration[name].reshape(3, 4) for name in ("P0", "P2", "Tr"))
            assert P0[0, 3] == P2[0, 3] == 0.0, "the poses are those of camera 0"
            images = sorted((home / "image_2").glob("*.png"))
            greys = [np.array(Image.open(path).convert("RGB"))[..., 1] for path in images]
            assert len(images) == len(poses) == len(times)
            for k, grey in enumerate(greys):
                path = root / split / home.name / f"proj_depth/groundtruth/image_02/{k:010d}.png"
                first, second, *flow = flows.pop(f"{home.name}-{k:04d}", (None,) * 4)
                assert first is None or (np.array_equal(first, grey) and np.array_equal(second, greys[k + 1]))
                assert (first is None) == (flow[0] is None)
                yield Seen(
                    f"{home.name}-{k:04d}",
                    depth_m=_missing(np.array(Image.open(path), np.uint16), 1 / 256),
                    flow_px=flow[0],
                    flow_seen_px=flow[1],
                    grey=grey,
                    gain=_gain(home / "gain.json"),
                    pose_from_first=np.vstack([poses[k], [0, 0, 0, 1]]),
                    K=moved(P2[:, :3], 0.5),
                    time_s=float(times[k]),
                )
        assert not flows


def _kitti_flows(home: Path) -> dict[str, tuple[np.ndarray | None, ...]]:
    """Both pictures and both kinds of flow by key, paired by the order of names as the flow loaders pair them."""
    lists = [sorted(home.glob(f"image_2/*_{n}.png")) for n in (10, 11)]
    lists += [sorted(home.glob(f"flow_{kind}/*_10.png")) for kind in ("occ", "noc")]
    lists[3] = lists[3] or [None] * len(lists[2])  # type: ignore[list-item]  # of a dataset without covisibility
    found = {}
    for first, second, *flows in zip(*lists, strict=True):
        pictures = (np.array(Image.open(path))[..., 0] for path in (first, second))
        found[first.name[: -len("_10.png")]] = (*pictures, *map(_kitti_flow, flows))
    return found


def _kitti_flow(path: Path | None) -> np.ndarray | None:
    if path is None:
        return None
    flow = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)[:, :, ::-1].astype(np.float64)
    return np.where(flow[..., 2:] > 0, (flow[..., :2] - 2**15) / 64.0, np.nan)


def monodepth2(root: Path) -> Iterator[Seen]:
    """`KITTIDepthDataset` with ``--png``; `MonoDataset` scales K; `evaluate_depth` reads the ground truth."""
    facts = json.loads((root / "splits/scenegen/intrinsics.json").read_text())
    path = root / "splits/scenegen/gt_depths.npz"
    truth = np.load(path)["data"] if path.exists() else []
    tested = 0
    for split in SPLITS:
        for line in (root / f"splits/scenegen/{split}_files.txt").read_text().splitlines():
            folder, frame, side = line.split()
            assert side == "l"
            for offset in (-1, 0, 1):
                assert (root / folder / f"image_02/data/{int(frame) + offset:010d}.png").exists()
            path = root / folder / f"proj_depth/groundtruth/image_02/{int(frame):010d}.png"
            depth = np.array(Image.open(path)).astype(np.float32) / 256
            if split == "test":
                assert np.array_equal(truth[tested], depth)
                tested += 1
            K = np.array(facts["K"])
            K[0, :] *= depth.shape[1]
            K[1, :] *= depth.shape[0]
            image = Image.open(root / folder / f"image_02/data/{int(frame):010d}.png").convert("RGB")
            yield Seen(
                f"{Path(folder).name}-{int(frame):04d}",
                depth_m=np.where(depth == 0, np.nan, depth.astype(np.float64)),
                grey=np.array(image)[..., 0],
                gain=_gain(root / folder / "gain.json"),
                K=moved(K[:3, :3], 0.5),
            )
    assert tested == len(truth)
