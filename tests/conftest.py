"""What holds for every test: nothing is drawn anew, nothing is measured against the clock of a busy machine.

Hypothesis tries the same examples in every run. New ones are searched for by ``pytest --hypothesis-profile=search``;
what it finds becomes an ``@example``.
"""

import random
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "same", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("search", settings.get_profile("same"), derandomize=False)
settings.load_profile("same")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Start the checks of each test's fixtures alike: beartype looks at one item of a sequence, drawn from here."""
    random.seed(0)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call() -> None:
    """Start those of the test itself alike, whether its fixtures were there already or not."""
    random.seed(0)


@pytest.fixture(scope="session", autouse=True)
def loopback_is_asked_directly() -> Iterator[None]:
    """A proxy, where one is set, cannot reach the servers of these tests."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("no_proxy", "NO_PROXY"):
            patch.setenv(name, "127.0.0.1,localhost")
        yield
