"""A device and frames for the tests of principal-ordinates propagation."""

from __future__ import annotations

import pytest

from airlight.errors import DeviceError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu, open_gpu


@pytest.fixture(scope="session")
def gpu() -> Gpu:
    try:
        return open_gpu()
    except DeviceError as error:
        pytest.skip(f"no graphics device: {error}")


@pytest.fixture
def commands(gpu: Gpu) -> Commands:
    return Commands(gpu)
