"""What every test can rely on."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="run the tests that take minutes, too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    skip = pytest.mark.skip(reason="takes minutes: run with --slow")
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(skip)


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Scenes, volumes and environment maps of others, beside the repository."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the data of others is not beside the repository")
    return folder


@pytest.fixture(autouse=True)
def _no_switches(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory):
    """No AIRLIGHT_* variable of the caller's reaches a test, and no test writes to his cache."""
    for name in [name for name in os.environ if name.startswith("AIRLIGHT_")]:
        if name != "AIRLIGHT_ADAPTER":  # which adapter the tests run on is the caller's choice
            monkeypatch.delenv(name)
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path_factory.getbasetemp() / "airlight-cache"))
