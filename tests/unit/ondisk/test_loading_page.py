"""Every snippet of docs/loading.md runs, one after the other, as a reader would run them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PAGE = (Path(__file__).parents[3] / "docs/loading.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```python\n(.*?)```", PAGE, re.S)
OPTIONAL = ("grain", "webdataset", "datasets", "torch", "lightning")


def available(snippet: str) -> bool:
    """Whether the libraries a snippet shows are installed."""
    import importlib.util

    asked = set(re.findall(r"^(?:import|from) (\w+)", snippet, re.M)) & set(OPTIONAL)
    asked |= {"torch"} if "adapters.torch" in snippet else set()
    asked |= {"torch", "lightning"} if "adapters.lightning" in snippet else set()
    found = [importlib.util.find_spec(name) for name in asked]
    return all(spec is not None and spec.origin is not None for spec in found)  # a mere folder has no origin


@pytest.mark.filterwarnings("ignore")
def test_every_snippet_runs(
    fakes: Any, pristine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fsspec

    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("SCENEGEN_CACHE", str(tmp_path))
    monkeypatch.setattr("scenegen_datasets.sensing.retake.read_lock", _with_a_camera)
    memory = fsspec.filesystem("memory")
    for file in (p for p in pristine.rglob("*") if p.is_file()):
        memory.pipe_file(f"/page/{file.relative_to(pristine)}", file.read_bytes())
    scope: dict[str, Any] = {"dataset": pristine, "url": "memory://page", "np": np}
    ran = [snippet for snippet in SNIPPETS if available(snippet)]
    for snippet in ran:
        exec(compile(snippet, "docs/loading.md", "exec"), scope)
    assert len(SNIPPETS) == 13 and len(ran) >= 8
    assert scope["sample"]["thermal"].dtype == np.uint16
    np.testing.assert_array_equal(scope["there"][0]["depth"], scope["pairs"][0]["depth"])
    assert len(scope["early"]) == 6 and len(scope["part"]) == 4
    solid = np.isfinite(scope["z"])
    assert (scope["ranges"] >= scope["z"]).all() and np.isfinite(scope["ranges"][solid]).all()
    thermal, depth = next(scope["examples"]())
    assert thermal.dtype == np.uint16 and depth.dtype == np.float32
    assert (scope["noisy"][0]["thermal"] != scope["pairs"][0]["thermal"]).any()
    if "frame" in scope:
        assert scope["frame"]["radiance"].dtype == np.float32
        assert sorted(s["key"] for s in scope["training"]) == sorted(s["key"] for s in scope["stream"])
    if "counts" in scope:
        assert scope["counts"].shape == scope["sample"]["thermal"].shape and scope["counts"].max() > 255
    if "batch" in scope:
        assert scope["depth"].shape[1:] == scope["sample"]["depth"].shape


def _with_a_camera(root: Path) -> dict[str, Any]:
    """Hand-made datasets have no camera in their lock; this is the one of a default recipe."""
    from scenegen_render.sensor.knobs import SensorKnobs

    return {"recipe": {"sensor": SensorKnobs().model_dump(mode="json")}}
