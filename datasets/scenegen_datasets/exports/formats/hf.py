"""Hugging Face: one Parquet file per clip with the types of `datasets` in its header, and a card that names the splits.

``load_dataset(DIRECTORY)`` gives 16-bit thermal and float depth as Pillow pictures, exactly, and flow as a numpy array
with ``with_format("numpy")``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from scenegen.foundation.canonical import canonical
from scenegen_datasets.codecs import png as counts_png
from scenegen_datasets.codecs import tiff
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import png
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.job import SPLITS
from scenegen_datasets.licence import checked_licence, hub_lines, licence_of

_TEXT, _FLAG = {"dtype": "string", "_type": "Value"}, {"dtype": "bool", "_type": "Value"}
_WHOLE, _REAL = {"dtype": "int32", "_type": "Value"}, {"dtype": "float64", "_type": "Value"}
_IMAGE = {"_type": "Image"}
_FACTS = ("hour", "latitude_deg", "sun_elevation_deg", "speed_mps")
_ROWS_PER_GROUP = 8


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a Parquet file."""
    import pyarrow.parquet as pq

    optional = [name for name in ("flow", "covisible", "semantic") if name in clip.layers]
    schema = _schema(clip, optional)
    path = stage.path(f"data/{clip.job.split}/{clip.job.name}.parquet")
    with pq.ParquetWriter(path, schema, compression="zstd", compression_level=1) as writer:
        for group in _groups(clip.pictures("thermal", "depth", *optional)):
            writer.write_table(_table(clip, group, schema))
    return Written()


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write the card, whose header tells the Hub the licence and `load_dataset` where the splits are."""
    there = [split for split in SPLITS if any(clip.split == split for clip in clips)]
    files = "".join(f"  - split: {_hub_name(split)}\n    path: data/{split}/*.parquet\n" for split in there)
    licence = "\n".join(hub_lines(checked_licence(licence_of(description))))
    stage.put(
        "README.md",
        f"---\n{licence}\nconfigs:\n- config_name: default\n  data_files:\n{files}---\n\n# {description['name']}\n\n"
        "Thermal (16-bit counts), metric depth (float32 metres, sky is infinite) and flow (pixels).\n",
    )


def _hub_name(split: str) -> str:
    return {"val": "validation"}.get(split, split)


def _features(clip: Clip, optional: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Types by column, as `datasets` writes them down."""
    rows, columns = clip.shape
    arrays: dict[str, dict[str, Any]] = {
        "flow": {"shape": [rows, columns, 2], "dtype": "float32", "_type": "Array3D"},
        "covisible": _IMAGE,
        "semantic": _IMAGE,
    }
    return {
        "key": _TEXT,
        "map": _TEXT,
        "world": _WHOLE,
        "clip": _WHOLE,
        "frame": _WHOLE,
        "is_pair": _FLAG,
        "time_s": _REAL,
        "thermal": _IMAGE,
        "depth": _IMAGE,
        **{name: arrays[name] for name in optional},
        "world_from_camera": {"shape": [4, 4], "dtype": "float64", "_type": "Array2D"},
        "K": {"shape": [3, 3], "dtype": "float64", "_type": "Array2D"},
        **dict.fromkeys(_FACTS, _REAL),
        "weather": _TEXT,
    }


def _schema(clip: Clip, optional: Sequence[str]) -> Any:
    import pyarrow as pa

    plain = {"string": pa.string(), "bool": pa.bool_(), "int32": pa.int32(), "float64": pa.float64()}
    fields = []
    features = _features(clip, optional)
    for name, feature in features.items():
        kind = feature["_type"]
        if kind == "Image":
            arrow = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
        elif kind == "Value":
            arrow = plain[feature["dtype"]]
        else:
            arrow = pa.float32() if feature["dtype"] == "float32" else pa.float64()
            for _ in feature["shape"]:
                arrow = pa.list_(arrow)
        fields.append(pa.field(name, arrow))
    return pa.schema(fields, metadata={"huggingface": canonical({"info": {"features": features}})})


def _groups(pictures: Iterator[Picture]) -> Iterator[list[Picture]]:
    group: list[Picture] = []
    for picture in pictures:
        group.append(picture)
        if len(group) == _ROWS_PER_GROUP:
            yield group
            group = []
    if group:
        yield group


def _table(clip: Clip, group: Sequence[Picture], schema: Any) -> Any:
    import pyarrow as pa

    columns = []
    for field in schema:
        values = [_value(clip, picture, field.name) for picture in group]
        if isinstance(values[0], np.ndarray):
            columns.append(_nested(np.stack(values)))
        else:
            columns.append(pa.array(values, field.type))
    return pa.Table.from_arrays(columns, schema=schema)


def _value(clip: Clip, picture: Picture, name: str) -> Any:
    """What one frame has in one column."""
    if name in ("thermal", "depth", "covisible", "semantic"):
        return {"bytes": _picture_bytes(picture, name), "path": None}
    if name == "flow":
        return picture["flow"]
    if name in ("key", "frame", "time_s", "world_from_camera", "K"):
        return getattr(picture, name)
    if name in ("map", "world", "clip"):
        return getattr(clip.job, name)
    if name == "is_pair":
        return picture.frame > 0
    return canonical(dict(clip.facts["weather"])).decode() if name == "weather" else float(clip.facts[name])


def _picture_bytes(picture: Picture, name: str) -> bytes:
    array = picture[name]
    if name == "thermal":
        return counts_png.encode(array)
    if name == "depth":
        return tiff.encode(array)
    return png(array.astype(np.uint8) * (255 if name == "covisible" else 1))


def _nested(array: np.ndarray) -> Any:
    """An array of n axes as a list column of n - 1 levels."""
    import pyarrow as pa

    level = pa.array(array.ravel())
    for axis in range(array.ndim - 1, 0, -1):
        lists = int(np.prod(array.shape[:axis]))
        level = pa.ListArray.from_arrays(np.arange(lists + 1, dtype=np.int32) * array.shape[axis], level)
    return level


FORMAT = Format(
    name="hf",
    readers="Hugging Face `datasets` (`load_dataset(DIRECTORY)`), any Parquet reader",
    layout="`data/SPLIT/CLIP.parquet`, `README.md` with the splits in its header (val is called validation)",
    range="that of the dataset",
    step="none",
    lost="instances, materials, temperature, radiance, backward flow, normals, the inertial table",
    sky="depth +inf",
    needs=("thermal", "depth"),
    takes=("flow", "covisible", "semantic"),
    bytes_per_pixel=12.0,
    write=write,
    finish=finish,
    extra="hf",
    modules=("pyarrow",),
)
