"""The plan does not know how far it is run."""

from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen_datasets.plan import last_world, plan, split_of

MAPS = st.lists(st.sampled_from(["city", "field", "coastline"]), min_size=1, max_size=3, unique=True)


@settings(deadline=None)
@given(MAPS, st.integers(1, 9), st.integers(1, 70), st.integers(1, 600), st.integers(1, 600))
def test_a_longer_plan_begins_with_the_shorter_one(
    maps: list[str], clips: int, pairs: int, some: int, more: int
) -> None:
    short, long = plan(maps, clips, pairs, some), plan(maps, clips, pairs, some + more)
    assert long[: len(short)] == short
    assert sum(job.pairs for job in short) >= some > sum(job.pairs for job in short[:-1])


@settings(deadline=None)
@given(MAPS, st.integers(1, 9), st.integers(1, 500))
def test_every_clip_is_planned_once_and_in_order(maps: list[str], clips: int, count: int) -> None:
    jobs = plan(maps, clips, 1, count)
    assert [job.ordinal for job in jobs] == list(range(count))
    assert len({job.name for job in jobs}) == count
    assert list(jobs) == sorted(jobs)
    assert {job.clip for job in jobs} <= set(range(clips))


def test_maps_take_turns_world_by_world() -> None:
    jobs = plan(["city", "field"], 2, 8, 64)
    assert [(job.map, job.world, job.clip) for job in jobs] == [
        ("city", 0, 0),
        ("city", 0, 1),
        ("field", 0, 0),
        ("field", 0, 1),
        ("city", 1, 0),
        ("city", 1, 1),
        ("field", 1, 0),
        ("field", 1, 1),
    ]


def test_validation_and_test_come_early_in_every_ten_worlds() -> None:
    assert [split_of(world) for world in range(10)] == ["train", "val", "test", *["train"] * 7]
    assert [split_of(world) for world in (11, 12, 13)] == ["val", "test", "train"]


def test_the_job_of_8000_pairs() -> None:
    jobs = plan(["city"], 8, 64, 8000)
    assert (len(jobs), len({job.world for job in jobs})) == (125, 16)
    assert {job.split for job in jobs} == {"train", "val", "test"}


@settings(deadline=None)
@given(MAPS, st.integers(1, 9), st.integers(1, 70), st.integers(1, 400), st.integers(0, 3000))
def test_a_plan_that_begins_later_is_a_piece_of_the_whole(
    maps: list[str], clips: int, pairs: int, some: int, first: int
) -> None:
    piece = plan(maps, clips, pairs, some, first_world=first)
    assert [job.ordinal for job in piece] == list(range(len(piece)))
    assert {job.world for job in piece[:1]} == {first}
    assert max(job.world for job in piece) == last_world(len(maps), clips, pairs, some, first)
    skipped = plan(maps, clips, pairs, first % 5 * clips * len(maps) * pairs + some)
    names = [(job.name, job.split) for job in plan(maps, clips, pairs, some, first_world=first % 5)]
    assert names == [(job.name, job.split) for job in skipped][-len(names) :]
