"""CPU time and size of every way to store a frame that was considered, and of the way that was taken.

Times are CPU milliseconds of one thread per frame: the fastest of several interleaved rounds over all frames. On a busy
machine they grow by a factor of two or three, so each is also given as a multiple of the SHA-256 of the frame's raw
arrays, measured in the same rounds. Frames are synthetic streets, or, for the figures that count, those of a dataset:

    python benchmarks/encode.py [--size 256] [--dataset DIR]
"""

from __future__ import annotations

import argparse
import hashlib
import io
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import frames as source
import numpy as np
import OpenEXR

from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.codecs import single_threaded
from scenegen_datasets.commit import ShardWriter
from scenegen_datasets.encode import encode_frame
from scenegen_datasets.invariants import violations
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS, layers_by_member
from scenegen_datasets.pixels import array_digest, encode_member
from scenegen_datasets.statistics import frame_statistics
from scenegen_datasets.verify.clip import check_clip

COUNT, ROUNDS = 8, 5
Shot = tuple[Any, Any, Any]


def fastest(jobs: dict[str, Callable[[Shot], Any]], shots: list[Shot]) -> dict[str, tuple[float, float]]:
    """CPU milliseconds and kilobytes per frame of each job, all jobs taking turns."""
    best = dict.fromkeys(jobs, float("inf"))
    size = dict.fromkeys(jobs, 0.0)
    for _ in range(ROUNDS):
        for name, job in jobs.items():
            start = time.process_time()
            results = [job(shot) for shot in shots]
            best[name] = min(best[name], (time.process_time() - start) / len(shots) * 1e3)
            size[name] = float(np.mean([len(r) if isinstance(r, bytes) else 0 for r in results])) / 1e3
    return {name: (best[name], size[name]) for name in jobs}


def arrays(shot: Shot) -> dict[str, Any]:
    frame, reading, _ = shot
    return {name: getattr(frame, name) for name in DEFAULT_LAYERS if name != "thermal"} | {
        "thermal": reading.counts
    }


def png(strategy: int | None, line_filter: int | None, level: int = 1) -> Callable[[Shot], bytes]:
    options = [cv2.IMWRITE_PNG_COMPRESSION, level]
    options += [] if strategy is None else [cv2.IMWRITE_PNG_STRATEGY, strategy]
    options += [] if line_filter is None else [cv2.IMWRITE_PNG_FILTER, line_filter]
    return lambda shot: bytes(cv2.imencode(".png", shot[1].counts, options)[1])


def tiff(compression: int, predictor: int) -> Callable[[Shot], bytes]:
    options = [cv2.IMWRITE_TIFF_COMPRESSION, compression, cv2.IMWRITE_TIFF_PREDICTOR, predictor]
    return lambda shot: bytes(cv2.imencode(".tiff", shot[0].depth, options)[1])


def truth(shot: Shot) -> dict[str, Any]:
    frame = shot[0]
    return {
        "radiance": frame.radiance,
        "temperature": frame.temperature,
        "semantic": frame.semantic.astype(np.uint32),
        "instance": frame.instance,
        "material": frame.material.astype(np.uint32),
        "covisible": frame.covisible.astype(np.float16),
    }


def flow(shot: Shot) -> dict[str, Any]:
    return {name: np.ascontiguousarray(shot[0].flow[..., k]) for k, name in enumerate("uv")}


def exr(kind: str, planes: Callable[[Shot], dict[str, Any]] = truth) -> Callable[[Shot], bytes]:
    def encode(shot: Shot) -> bytes:
        header = {"compression": getattr(OpenEXR, kind), "type": OpenEXR.scanlineimage}
        buffer = io.BytesIO()
        OpenEXR.File(header, planes(shot), 0).write(buffer)
        return buffer.getvalue()

    return encode


def choices() -> dict[str, Callable[[Shot], bytes]]:
    """What was weighed, the one taken marked with a star."""
    return {
        "thermal PNG level 1, library's filters": png(None, None),
        "thermal PNG level 6, library's filters": png(None, None, 6),
        "thermal PNG level 1, huffman, SUB": png(
            cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY, cv2.IMWRITE_PNG_FILTER_SUB
        ),
        "thermal PNG level 1, RLE, SUB *": png(cv2.IMWRITE_PNG_STRATEGY_RLE, cv2.IMWRITE_PNG_FILTER_SUB),
        "thermal PNG level 1, RLE, PAETH": png(cv2.IMWRITE_PNG_STRATEGY_RLE, cv2.IMWRITE_PNG_FILTER_PAETH),
        "depth TIFF deflate": tiff(8, 1),
        "depth TIFF deflate, predictor 3": tiff(8, 3),
        "depth TIFF LZW, predictor 3 *": tiff(5, 3),
        "flow EXR none *": exr("NO_COMPRESSION", flow),
        "flow EXR RLE": exr("RLE_COMPRESSION", flow),
        "flow EXR ZIP": exr("ZIP_COMPRESSION", flow),
        "flow EXR PIZ": exr("PIZ_COMPRESSION", flow),
        "truth EXR none": exr("NO_COMPRESSION"),
        "truth EXR RLE": exr("RLE_COMPRESSION"),
        "truth EXR ZIPS": exr("ZIPS_COMPRESSION"),
        "truth EXR ZIP *": exr("ZIP_COMPRESSION"),
        "truth EXR PIZ": exr("PIZ_COMPRESSION"),
        "truth EXR ZSTD (few readers)": exr("ZSTD_COMPRESSION"),
    }


def stages() -> dict[str, Callable[[Shot], Any]]:
    """What encoding one frame consists of."""
    groups = layers_by_member(DEFAULT_LAYERS)
    jobs: dict[str, Callable[[Shot], Any]] = {
        suffix: (lambda shot, s=suffix, g=group: encode_member(s, g, arrays(shot)))
        for suffix, group in groups.items()
    }
    jobs["digests"] = lambda shot: [array_digest(a) for a in arrays(shot).values()]
    jobs["guard"] = lambda shot: violations(arrays(shot))
    jobs["statistics"] = lambda shot: frame_statistics(shot[1].counts, shot[0].depth, shot[0].temperature, 0)
    jobs["whole frame, encoded"] = lambda shot: b"".join(
        m.data for m in encode_frame("k-0000", *shot).members
    )
    return jobs


def yardstick(shot: Shot) -> str:
    sums = hashlib.sha256()
    for array in arrays(shot).values():
        sums.update(array.data)
    return sums.hexdigest()


def clip(shots: list[Shot]) -> tuple[float, float, float]:
    """Encode, write, commit a clip, then verify it: CPU ms a frame for each, and kB a frame."""
    job = ClipJob(0, "city", 0, 0, "train", len(shots) - 1)
    rows, columns = shots[0][0].depth.shape
    K = tuple(map(tuple, shots[0][2].K.tolist()))
    record = ClipRecord(
        job,
        40.0,
        7,
        15,
        12.0,
        60.0,
        {},
        columns,
        rows,
        K,
        (8.0, 14.0),
        {},
        10.0,
        1.0,
        3.0,
        0,  # type: ignore[arg-type]
    )
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        start = time.process_time()
        with ShardWriter(root, job) as shard:
            for k, shot in enumerate(shots):
                shard.add(encode_frame(job.key(k), *shot))
            receipt = shard.commit(record, fingerprint="0" * 16)
        written = time.process_time()
        check = check_clip(root, job.receipt, quick=False)
        done = time.process_time()
    wrong = [f for f in check.findings if "times do not rise" not in f.reason and "K differs" not in f.reason]
    assert not wrong, wrong[0]
    n = len(shots) / 1e3
    return (written - start) / n, (done - written) / n, receipt.size / len(shots) / 1e3


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--dataset", type=Path)
    options = parser.parse_args()
    single_threaded()
    given = options.dataset
    shots = (
        list(source.stored(given, COUNT)) if given else [source.street(options.size, k) for k in range(COUNT)]
    )
    rows, columns = shots[0][0].depth.shape
    print(source.machine())
    print(f"{len(shots)} frames of {columns}x{rows} {'from a dataset' if given else '(synthetic streets)'}\n")
    yard = "SHA-256 of the raw arrays"
    for title, jobs in (("choices", choices()), ("stages", stages())):
        measured = fastest({yard: yardstick, **jobs}, shots)
        print(f"{title:42s} CPU ms      kB   of the SHA-256")
        for name, (ms, kb) in measured.items():
            print(f"  {name:40s} {ms:6.2f} {kb:7.1f}  {ms / measured[yard][0]:6.2f}")
        print()
    best = [min(column) for column in zip(*(clip(shots) for _ in range(ROUNDS)), strict=True)]
    print(f"encode + hash + tar + commit: {best[0]:.2f} CPU ms a frame, {best[2]:.0f} kB a frame")
    print(f"verify everything:            {best[1]:.2f} CPU ms a frame, {best[1] / best[0]:.2f} of the above")


if __name__ == "__main__":
    main()
