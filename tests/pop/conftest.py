"""A device and frames for the tests of principal-ordinates propagation."""

from __future__ import annotations

import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu


@pytest.fixture
def commands(gpu: Gpu) -> Commands:
    return Commands(gpu)
