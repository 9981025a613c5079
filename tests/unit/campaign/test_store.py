"""A campaign's directory: what is kept comes back, what is not whole is flown again, what differs is refused."""

import json
from pathlib import Path

import pytest

import flown
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_trainers.campaign.plan import batches
from scenegen_trainers.campaign.record import FlightRecord
from scenegen_trainers.campaign.store import BASE_POINT, CampaignStore


@pytest.fixture
def store(tmp_path: Path) -> CampaignStore:
    store = CampaignStore(tmp_path)
    store.open(flown.recipe())
    return store


def test_a_batch_comes_back_as_it_was(store: CampaignStore) -> None:
    batch = batches("city", 4, flown.recipe().campaign)[0]
    assert store.read(BASE_POINT, "oracle", batch) is None
    store.commit(BASE_POINT, "oracle", batch, flown.record(batch, (2,)))
    assert store.read(BASE_POINT, "oracle", batch) == flown.record(batch, (2,))
    assert store.read(BASE_POINT, "blind", batch) is None


def test_a_batch_cut_short_serves_fewer_flights_and_is_flown_again_for_more(store: CampaignStore) -> None:
    knobs = flown.recipe().campaign
    three, two, four = (batches("city", n, knobs)[0] for n in (3, 2, 4))
    store.commit(BASE_POINT, "oracle", three, flown.record(three))
    cut = store.read(BASE_POINT, "oracle", two)
    assert cut is not None
    assert [f.flight for f in cut.flights] == [0, 1]
    assert store.read(BASE_POINT, "oracle", four) is None


@pytest.mark.parametrize("damage", [b"", b"{}", b'{"schema": 1', b'{"schema": 99, "flights": []}'])
def test_a_damaged_batch_counts_as_not_flown(store: CampaignStore, damage: bytes) -> None:
    batch = batches("city", 4, flown.recipe().campaign)[0]
    store.commit(BASE_POINT, "oracle", batch, flown.record(batch))
    (path,) = store.root.rglob("00000.json")
    path.write_bytes(damage)
    assert store.read(BASE_POINT, "oracle", batch) is None


def test_another_recipe_is_refused_by_its_keys(store: CampaignStore) -> None:
    with pytest.raises(InputError, match=r"seed: 0 -> 5.*use the same one or another --out"):
        store.open(flown.recipe(seed=5))
    with pytest.raises(InputError, match=r"loop\.radius_m: 0\.35 -> 0\.5"):
        store.open(flown.recipe(loop={"radius_m": 0.5}))
    store.open(flown.recipe(layers=["thermal", "depth"]))  # decides no flight


def test_other_software_is_refused_until_it_is_allowed(store: CampaignStore) -> None:
    path = store.root / "campaign.json"
    held = json.loads(path.read_text())
    held["software"]["numpy"] = "0.9"
    path.write_text(json.dumps(held))
    with pytest.raises(InputError, match=r'other software \(numpy: "0\.9" -> .*--allow-mixed'):
        store.open(flown.recipe())
    store.open(flown.recipe(), allow_mixed=True)


def test_a_stranger_s_directory_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(InputError, match=r"not a campaign \(it holds thesis\.tex\)"):
        CampaignStore(tmp_path).open(flown.recipe())
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]


def test_links_are_not_written_through(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    root = tmp_path / "campaign"
    root.mkdir()
    (root / "flights").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="symbolic link"):
        CampaignStore(root).open(flown.recipe())


def test_what_a_killed_writer_left_is_removed(store: CampaignStore) -> None:
    batch = batches("city", 4, flown.recipe().campaign)[0]
    store.commit(BASE_POINT, "oracle", batch, flown.record(batch))
    (path,) = store.root.rglob("00000.json")
    left = path.with_name(".00001.json.77-12345.partial")
    left.write_bytes(b"half")
    store.open(flown.recipe())
    assert not left.exists()
    assert path.exists()


def test_a_flight_is_read_back_exactly_or_not_at_all() -> None:
    one = flown.flight(3, "collision", "wire")
    plain = json.loads(json.dumps(one.to_json()))
    assert FlightRecord.from_json(plain, "here") == one
    del plain["kind"]
    with pytest.raises(DatasetError, match="here: not a flight"):
        FlightRecord.from_json(plain, "here")
