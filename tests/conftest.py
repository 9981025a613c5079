"""What holds for every test: nothing is drawn anew and nothing is measured against the clock of a busy machine.

Hypothesis tries the same examples in every run. New ones are searched for by ``pytest --hypothesis-profile=search``;
what it finds becomes an ``@example``.
"""

import random

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "same", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("search", settings.get_profile("same"), derandomize=False)
settings.load_profile("same")


@pytest.fixture(autouse=True)
def same_items_checked_each_run() -> None:
    """Start each test's type checks alike: beartype looks at one item of a sequence, drawn from this generator."""
    random.seed(0)
