"""Datasets of somebody who means harm: refused in one line, in bounded memory, without a hang, nothing else touched.

One mutant of each kind; ``benchmarks/hostile.py`` makes hundreds.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent.parent))
from hostile_campaign import Campaign
from hostile_datasets import MUTANTS, READERS


@pytest.fixture(scope="module")
def campaign(finished_dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Campaign]:
    with Campaign(finished_dataset, tmp_path_factory.mktemp("hostile")) as running:
        yield running


@pytest.mark.parametrize("kind", sorted(MUTANTS))
def test_readers_refuse_in_one_line_or_read_what_is_sound(campaign: Campaign, kind: str) -> None:
    _, found = campaign.read(1, kind)
    assert found.keys() == READERS.keys()
    assert {what for what in found.values() if what.startswith("WRONG")} == set(), (kind, found)


def test_a_sound_dataset_passes_them_all(campaign: Campaign) -> None:
    """The sound dataset passes all readers, so that a refusal above means something."""
    _, found = campaign.read(0, "nothing")
    assert set(found.values()) == {"sound"}
