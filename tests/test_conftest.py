"""What tests lean on: needs that are not met name what to type, and orders have numbers."""

from __future__ import annotations

import itertools
from pathlib import Path
from types import SimpleNamespace

import pytest


@pytest.fixture
def ours(pytestconfig):
    """The module conftest.py beside this file."""
    file = str(Path(__file__).with_name("conftest.py"))
    plugins = pytestconfig.pluginmanager.get_plugins()
    return next(plugin for plugin in plugins if getattr(plugin, "__file__", "") == file)


class Item:
    """A test with needs, slow or not."""

    def __init__(self, *needs, slow=False):
        self.marks = [pytest.mark.needs(need).mark for need in needs]
        self.slow = slow

    def iter_markers(self, name):
        return self.marks if name == "needs" else []

    def get_closest_marker(self, name):
        return self.slow if name == "slow" else None


def test_a_skip_names_what_is_missing_and_the_remedies(ours, monkeypatch):
    monkeypatch.setattr(ours.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(ours.shutil, "which", lambda name: None)
    monkeypatch.setattr(ours, "find_llvm", lambda: None)
    monkeypatch.setattr(ours, "_remedy", ours._remedy.__wrapped__)  # without what it remembers
    browsers = ("chromium", "google-chrome")
    needy = Item("uvicorn", "websockets", "imgui_bundle", browsers)
    assert ours._why_not(needy, is_slow_welcome=False) == (
        'needs uvicorn and websockets and imgui_bundle and chromium: pip install ".[view]", '
        "apt install chromium"
    )
    told = ours._why_not(Item("libLLVM"), is_slow_welcome=False)
    assert told.startswith("needs libLLVM: ") and "DRJIT_LIBLLVM_PATH" in told
    with pytest.raises(pytest.UsageError, match="'no_extra_brings_this'"):
        ours._why_not(Item("no_extra_brings_this"), is_slow_welcome=False)


def test_what_is_there_is_not_skipped(ours):
    needy = Item("pytest", ("no-such-shell", "sh"), slow=True)
    assert ours._why_not(needy, is_slow_welcome=True) == ""
    assert ours._why_not(needy, is_slow_welcome=False) == "takes minutes: run with --slow"


def test_another_order_is_the_seed_s_and_keeps_files_together(ours):
    names = [f"tests/{file}.py::test_{k}" for file in "abcd" for k in range(5)]
    orders = []
    for seed in (1, 1, 2):
        items = [SimpleNamespace(nodeid=name) for name in names]
        ours._shuffle(items, seed)
        orders.append([item.nodeid for item in items])
    assert orders[0] == orders[1] != orders[2]
    assert sorted(orders[2]) == names != orders[2]
    files = [name.split("::")[0] for name in orders[2]]
    assert sum(a != b for a, b in itertools.pairwise(files)) == 3
