"""Rerun: one recording per clip to look at and to scrub through.

Columns are sent whole, since logging row by row would add the time of the export to every row. Rerun gives rows and
chunks identifiers of its own, which depend on when they were made: of all exports this alone is not the same byte for
byte twice.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scenegen.classes import CLASSES
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage

CAMERA = "world/camera"
"""Entity of the pinhole; pictures lie below it."""


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a recording."""
    import rerun as rr

    optional = [name for name in ("semantic", "temperature") if name in clip.layers]
    recording = rr.RecordingStream("thermal-scenegen", recording_id=clip.job.name, send_properties=False)
    recording.save(str(stage.path(f"{clip.job.split}/{clip.job.name}.rrd")))
    try:
        _send_static(rr, recording)
        for picture in clip.pictures("thermal", "depth", *optional):
            _send(rr, recording, picture, clip.shape)
        recording.flush()
    finally:
        recording.disconnect()
    stage.prove_room()  # what `disconnect` cannot append it only logs
    return Written()


def _send_static(rr: Any, recording: Any) -> None:
    """The world's axes, and what the class ids mean."""
    classes = [rr.AnnotationInfo(int(c.id), label=c.name, color=c.colour) for c in CLASSES]
    for entity, static in (
        ("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP),
        (f"{CAMERA}/semantic", rr.AnnotationContext(classes)),
    ):
        rr.log(entity, static, static=True, recording=recording)


def _send(rr: Any, recording: Any, picture: Picture, shape: tuple[int, int]) -> None:
    times = [
        rr.TimeColumn("frame", sequence=[picture.frame]),
        rr.TimeColumn("time", duration=[picture.time_s]),
    ]
    for entity, columns in _columns(rr, picture, shape).items():
        rr.send_columns(entity, indexes=times, columns=columns, recording=recording)


def _columns(rr: Any, picture: Picture, shape: tuple[int, int]) -> dict[str, Any]:
    """Everything a frame shows, by entity. Our camera axes are Rerun's own: right, down, forward."""
    rows, columns = shape
    pose = picture.world_from_camera
    kinds = {
        "thermal": (rr.Image, "u16", {"color_model": "l"}),
        "depth": (rr.DepthImage, "f32", {}),
        "semantic": (rr.SegmentationImage, "u8", {}),
        "temperature": (rr.Image, "f32", {"color_model": "l"}),
    }
    sent = {
        CAMERA: [
            *rr.Transform3D.columns(translation=[pose[:3, 3]], mat3x3=[pose[:3, :3]]),
            *rr.Pinhole.columns(
                image_from_camera=[picture.K],
                resolution=[[columns, rows]],
                camera_xyz=[rr.components.ViewCoordinates.RDF],
            ),
        ]
    }
    for name, array in picture.arrays.items():
        kind, datatype, model = kinds[name]
        form = rr.components.ImageFormat(width=columns, height=rows, channel_datatype=datatype, **model)
        data = np.ascontiguousarray(array).view(np.uint8).reshape(1, -1)
        sent[f"{CAMERA}/{name}"] = kind.columns(buffer=data, format=form)
    return sent


FORMAT = Format(
    name="rerun",
    readers="the Rerun viewer (`rerun CLIP.rrd`)",
    layout="`SPLIT/CLIP.rrd`: `world/camera` (pose, pinhole), below it `thermal`, `depth`, `semantic`, `temperature`",
    range="that of the dataset",
    step="poses and K float32",
    lost="flow, instances, materials, radiance, the inertial table; bytes differ from run to run (identifiers of rows)",
    sky="depth +inf",
    needs=("thermal", "depth"),
    takes=("semantic", "temperature"),
    bytes_per_pixel=11.5,
    write=write,
    extra="rerun",
    modules=("rerun",),
)
