"""What pytest has where this package is installed: the fixture `tmcl_bench`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from .testing import Bench, BenchGateway


@pytest.fixture
def tmcl_bench() -> Iterator[Callable[..., BenchGateway]]:
    """`d = tmcl_bench("TMCM-3110", unit="mm", screw_pitch=5)`: as `tmcl.testing.bench`, until the
    test ends. What tmcld has said is shown where a test fails."""
    with ExitStack() as ending:

        def begin(*models: str, **settings: Any) -> BenchGateway:
            made = ending.enter_context(Bench(*models, **settings))
            ending.callback(lambda: print(made.log()))
            return ending.enter_context(made.connect())

        yield begin
