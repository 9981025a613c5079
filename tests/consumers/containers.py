"""Readers of containers, each by the library that owns the format."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from consumers.pictures import _drives
from consumers.seen import EXACT, Seen


def unpack(root: Path) -> Iterator[Seen]:
    """OpenCV for thermal and depth, OpenEXR for the rest."""
    for home in _drives(root):
        assert json.loads((home / "clip.json").read_text())["job"]["split"] == home.parent.name
        for path in sorted(home.glob("*.thermal.png")):
            stem = path.name.partition(".")[0]
            facts = json.loads((home / f"{stem}.json").read_text())
            truth, flow = (_channels(home / f"{stem}.{name}.exr") for name in ("truth", "flow"))
            exact = {
                "thermal": cv2.imread(str(path), cv2.IMREAD_UNCHANGED),
                "depth": cv2.imread(str(home / f"{stem}.depth.tiff"), cv2.IMREAD_UNCHANGED),
                **_in_memory(truth),
            }
            if flow:
                exact["flow"] = np.stack([flow["u"], flow["v"]], axis=-1)
            yield Seen(
                facts["key"],
                exact,
                pose=np.array(facts["world_from_camera"]),
                K=np.array(facts["K"]),
                time_s=facts["time_s"],
            )


def _channels(path: Path) -> dict[str, np.ndarray]:
    import OpenEXR

    if not path.exists():  # none of its layers is stored
        return {}
    channels = OpenEXR.File(str(path), True, False).channels()
    return {name: channel.pixels for name, channel in channels.items()}


def _in_memory(channels: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Layers of one channel under their own names, in the types of the dataset's page."""
    kinds = {"semantic": np.uint8, "material": np.uint16, "instance": np.uint32, "covisible": bool}
    kinds |= {"radiance": np.float32, "temperature": np.float32}
    return {name: channels[name].astype(kind) for name, kind in kinds.items() if name in channels}


def exr(root: Path) -> Iterator[Seen]:
    """OpenEXR's own module; header attributes for pose, camera and time."""
    import OpenEXR

    for path in sorted(p for home in _drives(root) for p in home.glob("*.exr")):
        file = OpenEXR.File(str(path), True, False)
        header, pixels = file.header(), {n: c.pixels for n, c in file.channels().items()}
        exact = {**_in_memory(pixels), "thermal": pixels["thermal"].astype(np.uint16), "depth": pixels["Z"]}
        if "forward.u" in pixels:
            exact["flow"] = np.stack([pixels["forward.u"], pixels["forward.v"]], axis=-1)
        if "forward.covisible" in pixels:
            exact["covisible"] = pixels["forward.covisible"].astype(bool)
        assert header["unit.Z"] == "m"
        pose, K = (np.array(json.loads(header[name])) for name in ("world_from_camera", "K"))
        yield Seen(header["key"], exact, pose=pose, K=K, time_s=float(header["time_s"]))


def hf(root: Path) -> Iterator[Seen]:
    """`datasets.load_dataset` on the directory, cached beside it."""
    import datasets

    loaded = datasets.load_dataset(str(root), cache_dir=str(root.parent / "hf-cache"))
    for split in loaded.values():
        flows = split.with_format("numpy", columns=["flow"]) if "flow" in split.features else None
        rest = split.remove_columns([name for name in ("flow",) if flows is not None])
        for k in range(len(split)):
            row = rest[k]
            exact = {"thermal": np.array(row["thermal"], np.uint16), "depth": np.array(row["depth"])}
            if "semantic" in row:
                exact["semantic"] = np.array(row["semantic"])
            if "covisible" in row:
                exact["covisible"] = np.array(row["covisible"]) > 127
            if flows is not None:
                exact["flow"] = np.asarray(flows[k]["flow"])
            assert row["is_pair"] == (row["frame"] > 0)
            assert "wind_mps" in json.loads(row["weather"])
            pose, K = (np.array(row[name], float) for name in ("world_from_camera", "K"))
            yield Seen(row["key"], exact, pose=pose, K=K, time_s=row["time_s"])


def zarr(root: Path) -> Iterator[Seen]:
    """The zarr library, from the root of the store."""
    import zarr as library

    store = library.open_group(str(root / "dataset.zarr"), mode="r")
    for split in sorted(store.group_keys()):
        for name in store[split].attrs["clips"]:
            yield from _stacked(name, store[f"{split}/{name}"])
            _check_axes(
                {a: (x.metadata.dimension_names, x.shape) for a, x in store[f"{split}/{name}"].arrays()}
            )
            assert store[f"{split}/{name}"].attrs["clip"]["job"]["split"] == split


def hdf5(root: Path) -> Iterator[Seen]:
    """h5py."""
    import h5py

    for path in sorted(p for split in ("train", "val", "test") for p in (root / split).glob("*.h5")):
        with h5py.File(path) as file:
            assert file["depth"].attrs["unit"] == "m"
            assert json.loads(file.attrs["clip"])["job"]["split"] == path.parent.name
            yield from _stacked(path.stem, file)
            _check_axes({name: (tuple(x.attrs["axes"]), x.shape) for name, x in file.items()})


def _check_axes(arrays: dict[str, tuple[tuple[str, ...], tuple[int, ...]]]) -> None:
    """As `xarray.open_zarr` demands: every axis has a name, and within a clip a name has one length."""
    lengths: dict[str, int] = {}
    for name, (axes, shape) in arrays.items():
        for axis, length in zip(axes, shape, strict=True):
            assert lengths.setdefault(axis, length) == length, (name, axis)


def _stacked(name: str, arrays: object) -> Iterator[Seen]:
    there = [layer for layer in EXACT if layer in arrays]  # type: ignore[operator]
    for k in range(arrays["depth"].shape[0]):  # type: ignore[index]
        exact = {layer: np.asarray(arrays[layer][k]) for layer in there}  # type: ignore[index]
        pose, K, time_s = (np.asarray(arrays[n][k]) for n in ("world_from_camera", "K", "time_s"))  # type: ignore[index]
        yield Seen(f"{name}-{k:04d}", exact, pose=pose, K=K, time_s=float(time_s))


def rerun(root: Path) -> Iterator[Seen]:
    """Rerun's reader of recordings: chunks of components by entity and timeline."""
    from rerun.chunk import RrdReader

    for path in sorted(p for split in ("train", "val", "test") for p in (root / split).glob("*.rrd")):
        rows: dict[int, dict[str, np.ndarray]] = {}
        for chunk in RrdReader(str(path)).stream():
            batch = chunk.to_record_batch()
            if "frame" not in batch.schema.names:
                continue
            for k, frame in enumerate(batch.column("frame").to_pylist()):
                row = rows.setdefault(frame, {"time": batch.column("time")[k].value})
                for name in batch.schema.names[3:]:
                    row[f"{chunk.entity_path}:{name}"] = _component(batch.column(name).slice(k, 1))
        for frame, row in sorted(rows.items()):
            yield _rerun_frame(f"{path.stem}-{frame:04d}", row)


def _component(column: object) -> np.ndarray:
    """Numbers of one component of one row; of structs the fields as they are."""
    while hasattr(column, "flatten") and "list" in str(column.type):  # type: ignore[attr-defined]
        column = column.flatten()  # type: ignore[attr-defined]
    if "struct" in str(column.type):  # type: ignore[attr-defined]
        return column.to_pylist()[0]  # type: ignore[attr-defined, no-any-return]
    return column.to_numpy(zero_copy_only=False)  # type: ignore[attr-defined, no-any-return]


def _rerun_frame(key: str, row: dict[str, np.ndarray]) -> Seen:
    camera = "/world/camera"
    kinds = {"thermal": ("Image", np.uint16), "temperature": ("Image", np.float32)}
    kinds |= {"depth": ("DepthImage", np.float32), "semantic": ("SegmentationImage", np.uint8)}
    exact = {}
    for name, (kind, dtype) in kinds.items():
        if f"{camera}/{name}:{kind}:format" not in row:
            continue
        form = row[f"{camera}/{name}:{kind}:format"]
        data = row[f"{camera}/{name}:{kind}:buffer"].view(dtype)
        exact[name] = data.reshape(form["height"], form["width"])
    pose = np.eye(4)
    pose[:3, :3] = row[f"{camera}:Transform3D:mat3x3"].reshape(3, 3).T  # columns first
    pose[:3, 3] = row[f"{camera}:Transform3D:translation"]
    K = row[f"{camera}:Pinhole:image_from_camera"].reshape(3, 3).T.astype(float)
    assert row[f"{camera}:Pinhole:camera_xyz"].tolist() == [3, 2, 5]  # right, down, forward
    return Seen(key, exact, pose=pose, K=K, time_s=float(row["time"]) * 1e-9)
