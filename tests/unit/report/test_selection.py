"""What a report shows stays within its budget and shows every map by night and by day."""

import io
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from scenegen_datasets.pictures.ramp import depth_ticks
from scenegen_datasets.pictures.shot import Shot
from scenegen_datasets.report.depth_bar import depth_bar
from scenegen_datasets.report.media import flight_within, tiles, webp
from scenegen_datasets.report.origin import cost, read_log
from scenegen_datasets.report.selection import spread_out
from scenegen_datasets.report.words import decimals, plain, tied


def test_the_bar_of_depth_puts_its_words_where_the_distances_are() -> None:
    drawn = ElementTree.fromstring(depth_bar(2.0, 200.0)).find("svg")
    assert drawn is not None
    words = [(e.text, float(e.get("x", 0))) for e in drawn.iter("text")]
    assert [said for said, _ in words] == ["2\u00a0m", "10\u00a0m", "200\u00a0m"]
    low, ten, high = (x for _, x in words)
    assert (ten - low) / (high - low) == pytest.approx(np.log(5.0) / np.log(100.0), abs=0.002)
    assert depth_ticks(5.0, 1000.0) == [5.0, 100.0, 1000.0]  # 10 m would stand on the 5
    assert depth_ticks(5.0, 10.0) == [5.0, 10.0]


def clip(map: str, sun_deg: float) -> dict[str, object]:
    return {"job": {"map": map}, "sun_elevation_deg": sun_deg}


def test_every_map_from_the_lowest_sun_to_the_highest() -> None:
    facts = {k: clip("city" if k % 2 else "field", float(sun)) for k, sun in enumerate(range(60, -60, -10))}
    chosen = spread_out(facts, 4)
    assert [facts[k]["job"] for k in chosen] == [{"map": "city"}] * 2 + [{"map": "field"}] * 2
    suns = [facts[k]["sun_elevation_deg"] for k in chosen]
    assert suns[0] < 0 < suns[1] and suns[2] < 0 < suns[3]  # type: ignore[operator]
    assert spread_out({7: clip("city", 3.0)}, 10) == [7]
    assert len(spread_out({k: clip(f"map{k}", 0.0) for k in range(9)}, 4)) == 9  # no map is left out


def noise(k: int) -> Shot:
    rng = np.random.default_rng(k)
    counts = rng.integers(3000, 6000, (48, 64)).astype(np.uint16)
    return Shot(
        "x", "facts", counts, counts.astype(np.float32) / 20, rng.uniform(1, 99, (48, 64)).astype(np.float32)
    )


def frames(data: bytes) -> int:
    with Image.open(io.BytesIO(data)) as image:
        return int(getattr(image, "n_frames", 1))


def test_a_flight_is_cut_until_it_fits() -> None:
    shots = [noise(k) for k in range(16)]
    whole = flight_within(shots, 10**9)
    cut = flight_within(shots, len(whole.data) // 3)
    assert (frames(whole.data), frames(cut.data)) == (16, 4)
    assert len(cut.data) <= len(whole.data) // 3
    assert frames(flight_within(shots, 1).data) == 4  # something is always shown


def test_a_flight_moves_and_its_still_is_where_it_starts() -> None:
    film = flight_within([noise(k) for k in range(5)], 10**9)
    assert film.layers == ("thermal", "depth")
    with Image.open(io.BytesIO(film.data)) as moving, Image.open(io.BytesIO(film.still)) as still:
        assert moving.size == still.size == (film.width, film.height)
        shown = []
        for k in range(5):
            moving.seek(k)
            shown.append(np.asarray(moving.convert("RGB"), np.int32))
        first = np.asarray(still.convert("RGB"), np.int32)
    assert all(np.abs(a - b).mean() > 5.0 for a, b in pairwise(shown))
    assert np.abs(shown[0] - first).mean() < 3.0 < np.abs(shown[4] - first).mean()


def test_numbers_are_written_as_people_write_them() -> None:
    assert [decimals(span) for span in (300.0, 24.0, 9.0, 0.5, 0.0)] == [0, 1, 2, 3, 3]
    assert (plain(-9.98, 1), plain(-0.001, 2), plain(1234.5, 0)) == ("−10.0", "0.00", "1,234")
    assert tied("0.1 % of 5 km/h and 2 px") == "0.1\u00a0% of 5 km/h and 2\u00a0px"


def test_pictures_of_ids_are_exact() -> None:
    rng = np.random.default_rng(1)
    image = rng.integers(0, 255, (32, 32, 3)).astype(np.uint8)
    with Image.open(io.BytesIO(webp(image, exact=True))) as kept:
        np.testing.assert_array_equal(np.asarray(kept), image)
    assert [tile.layer for tile in tiles(noise(0), (1.0, 100.0))] == ["thermal", "depth"]


def test_cost_adds_up_stages_and_runs(tmp_path: Path) -> None:
    lines = [
        '{"time": "2026-01-01T10:00:00+00:00", "event": "start", "machine": {"cpus": 2}, "processes": 2}',
        '{"time": "2026-01-01T10:01:00+00:00", "event": "clip", "clip": "a", "stages": {"trace": [4, 3]}, "bytes": 5}',
        "not a line",
        '{"time": "2026-01-02T10:00:00+00:00", "event": "start", "machine": {"cpus": 2}, "processes": 2}',
        '{"time": "2026-01-02T10:00:30+00:00", "event": "clip", "clip": "b", "stages": {"trace": [2, 1]}, "bytes": 5}',
    ]
    (tmp_path / "run.log.jsonl").write_text("\n".join(lines))
    page = cost(read_log(tmp_path))
    assert "2.0 s</div>" in page  # CPU a clip
    assert "1 min 30 s" in page and "2 runs" in page  # the night between them is not counted
    assert "not known" in cost(read_log(tmp_path / "none"))
