"""Datasets of somebody who means harm: refused in one line, in bounded memory, without a hang, nothing else touched.

One mutant of each kind; ``benchmarks/hostile.py`` makes hundreds.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from hostile.campaign import Campaign
from hostile.mutants import MUTANTS
from hostile.readers import READERS

MOST_MIB = 1000
"""Of the reading process, libraries included."""


@pytest.fixture(scope="module")
def campaign(finished_dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Campaign]:
    with Campaign(finished_dataset, tmp_path_factory.mktemp("hostile")) as running:
        yield running


@pytest.mark.parametrize("kind", sorted(MUTANTS))
def test_readers_refuse_in_one_line_or_read_what_is_sound(campaign: Campaign, kind: str) -> None:
    read = campaign.read(sorted(MUTANTS).index(kind), kind)
    assert len(read.found) >= 7
    assert read.wrong == {}
    assert read.peak_MiB < MOST_MIB


def test_a_sound_dataset_passes_them_all(campaign: Campaign) -> None:
    """The sound dataset passes all readers, so that a refusal above means something."""
    found = campaign.read(0, "nothing", tuple(READERS)).found
    assert set(found) == set(READERS) and set(found.values()) == {"sound"}
