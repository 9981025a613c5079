"""The plan: the same flights whoever flies them, however many are asked for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenegen_datasets.plan import split_of
from scenegen_trainers.campaign.knobs import CampaignKnobs
from scenegen_trainers.campaign.plan import batch_of, batches


@given(st.integers(1, 500), st.integers(1, 60), st.integers(1, 9))
def test_batches_hold_every_flight_once(flights: int, size: int, per_world: int) -> None:
    knobs = CampaignKnobs(flights_per_batch=size, batches_per_world=per_world)
    plan = batches("city", flights, knobs)
    assert [k for batch in plan for k in batch.flights] == list(range(flights))
    assert all(batch.count == size for batch in plan[:-1])
    assert [batch.index for batch in plan] == list(range(len(plan)))
    assert [batch.clip for batch in plan] == [k % per_world for k in range(len(plan))]


def test_more_flights_leave_the_first_where_they_were() -> None:
    knobs = CampaignKnobs()
    assert batches("city", 100, knobs) == batches("city", 400, knobs)[:4]
    assert batches("city", 110, knobs)[4].first == batches("city", 400, knobs)[4].first


@pytest.mark.parametrize("split", ["train", "val", "test"])
def test_flights_stay_in_the_worlds_of_their_split(split: str) -> None:
    plan = batches("city", 1000, CampaignKnobs(split=split))
    assert {split_of(batch.world) for batch in plan} == {split}
    assert len({batch.world for batch in plan}) == 10


def test_all_worlds_are_those_of_the_dataset_plan_in_order() -> None:
    plan = batches("city", 300, CampaignKnobs(split="all", batches_per_world=2))
    assert [batch.world for batch in plan] == [k // 2 for k in range(12)]


def test_a_flight_knows_its_batch() -> None:
    knobs = CampaignKnobs(flights_per_batch=10)
    assert batch_of("city", 17, 25, knobs) == batches("city", 25, knobs)[1]
    assert batch_of("city", 24, 25, knobs).count == 5
