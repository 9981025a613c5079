"""Inside a worker process: export one clip after another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from scenegen_datasets.codecs import single_threaded
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.marker import FOLDER, Marker, write_marker
from scenegen_datasets.exports.options import options_from
from scenegen_datasets.exports.registry import format_called
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.source import open_source


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Any], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`.

    Parameters
    ----------
    setup : mapping
        ``dataset``, ``root``, ``format`` and ``options`` (`Options.heeded`).
    """
    single_threaded()
    dataset, root = Path(setup["dataset"]), Path(setup["root"])
    target, options = format_called(setup["format"]), options_from(setup["options"])
    source, reader = open_source(dataset, allow_partial=False), ShardReader(dataset)

    def export_clip(payload: dict[str, Any], told: Any) -> dict[str, Any]:
        """Write one clip, then its marker."""
        clip = Clip(source, reader, payload["position"])
        with Stage(root, f"{FOLDER}/work/{clip.job.name}") as stage:
            written = target.write(clip, stage, options)
            write_marker(root, clip.job.name, Marker(stage.commit(), written, clip.sha256))
        return {}

    return export_clip
