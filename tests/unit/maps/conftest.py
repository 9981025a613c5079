"""Assertions that the tests of all maps share explain themselves like those of the tests."""

import pytest

pytest.register_assert_rewrite("worlds")
