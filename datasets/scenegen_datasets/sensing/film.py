"""One clip of a new dataset: stored frames, seen by another camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation import canonical
from scenegen.foundation.rng import stream
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.codecs import single_threaded
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.encode import EncodedFrame, FrameMeta, encode_frame
from scenegen_datasets.index import rows_of
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import LAYERS, layers_by_member
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.scale import sensor_facts
from scenegen_datasets.sensing.binning import binned
from scenegen_datasets.sensing.camera import CameraKeys
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.sensor.sense import Microbolometer

_OF_THE_META = ("key", "time_s", "world_from_camera", "K", "sensor")


@dataclass(frozen=True)
class Film:
    """What makes clips of one new dataset.

    Attributes
    ----------
    source, root : Path
        Where radiance is stored, and the new dataset.
    keys : CameraKeys
        The new camera.
    side : int
        Stored pixels along the side of one of its pixels.
    seed : int
        Of its noise.
    fingerprint : str
        Id for the receipts.
    """

    source: Path
    root: Path
    keys: CameraKeys
    side: int
    seed: int
    fingerprint: str

    def make(self, job: ClipJob) -> int:
        """Sense and commit one clip; returns the bytes of its shard.

        Raises
        ------
        DatasetError
            If the stored clip is damaged.
        """
        receipt = read_receipt(self.source, job.receipt)
        stored = layers_by_member(receipt.layers)
        record = self._record(receipt.clip)
        frames = self._frames(record, rows_of(receipt), stored, receipt.layers)
        return commit_clip(self.root, record, frames, fingerprint=self.fingerprint).size

    def _record(self, clip: ClipRecord) -> ClipRecord:
        (fx, skew, cx), (_, fy, cy), last = clip.K
        n = self.side
        K = ((fx / n, skew / n, cx / n), (0.0, fy / n, cy / n), last)
        facts = sensor_facts(self.keys.sensor, clip.band_um)
        return replace(clip, width_px=clip.width_px // n, height_px=clip.height_px // n, K=K, sensor=facts)

    def _frames(
        self, record: ClipRecord, rows: Any, stored: Mapping[str, Any], layers: tuple[str, ...]
    ) -> Iterator[EncodedFrame]:
        job, matrix = record.job, np.array(record.K)
        centre = float(matrix[0, 2]), float(matrix[1, 2])
        camera = Camera(record.width_px, record.height_px, float(matrix[0, 0]), centre, record.band_um)
        rng = stream(self.seed, "clip", job.map, job.world, job.clip, "sensor")
        detector = Microbolometer(camera, self.keys.sensor, rng)
        reader = ShardReader(self.source)
        for k, row in enumerate(rows):
            arrays = reader.frame(row, job, stored)
            told = canonical.parse(reader.stored(row, job, "json"), f"{job.key(k)}.json")
            frame = binned(_truth(arrays), self.side)
            reading = detector.read(frame.radiance, float(told["time_s"]))
            meta = FrameMeta(
                float(told["time_s"]),
                np.array(told["world_from_camera"], np.float64),
                matrix,
                {**told["sensor"], "saturated": reading.saturated},
                {name: value for name, value in told.items() if name not in _OF_THE_META},
                arrays.get("imu"),
            )
            yield encode_frame(job.key(k), frame, reading, meta, layers)
        reader.close()


def _truth(arrays: Mapping[str, Any]) -> Frame:
    """The noise-free frame of stored layers."""
    return Frame(
        **{name: arrays[name] for name in LAYERS if name in arrays and name not in ("thermal", "imu")}
    )


def setup_of(film: Film) -> dict[str, Any]:
    """Plain data that makes the same film in another process."""
    paths = {"source": str(film.source.resolve()), "root": str(film.root.resolve())}
    plain = {"side": film.side, "seed": film.seed, "fingerprint": film.fingerprint}
    return {**paths, **plain, "keys": film.keys.model_dump(mode="json")}


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Any], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`."""
    single_threaded()
    film = Film(
        source=Path(setup["source"]),
        root=Path(setup["root"]),
        keys=CameraKeys.model_validate(setup["keys"]),
        side=setup["side"],
        seed=setup["seed"],
        fingerprint=setup["fingerprint"],
    )

    def make(payload: dict[str, Any], told: Any) -> dict[str, Any]:
        return {"bytes": film.make(ClipJob(**payload))}

    return make


def payload_of(job: ClipJob) -> dict[str, Any]:
    """What a worker is told of a clip."""
    return asdict(job)
