"""An option that nobody has is named where it was written, not where it would arrive."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError
from scenegen_datasets import PairDataset

pytest.importorskip("torch")


def test_of_the_loader(pristine: Path) -> None:
    from scenegen_datasets.adapters.torch import PairLoader

    with pytest.raises(InputError, match="no option is called 'num_workers'; perhaps you meant 'workers'"):
        PairLoader(PairDataset(pristine), 2, num_workers=1)
    assert len(PairLoader(PairDataset(pristine), 2, seed=1, shuffle=False, even=True, rank=1, ranks=2)) == 5


@pytest.mark.filterwarnings("ignore")
def test_of_the_data_module(pristine: Path) -> None:
    pytest.importorskip("lightning")
    from scenegen_datasets.adapters.lightning import PairModule

    with pytest.raises(InputError, match="no option is called 'seq_len'; perhaps you meant 'seq_length'"):
        PairModule(pristine, 2, seq_len=3)
    with pytest.raises(InputError, match="no option is called 'order'"):
        PairModule(pristine, 2, order=3)
    found = PairModule(pristine, 2, seq_length=2, frame_skip=1, allow_partial=True).val_dataloader()
    assert len(found) == 1
