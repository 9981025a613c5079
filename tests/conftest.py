"""What holds for every test."""

import random

import pytest


@pytest.fixture(autouse=True)
def same_items_checked_each_run() -> None:
    """Start each test's type checks alike: beartype looks at one item of a sequence, drawn from this generator."""
    random.seed(0)
