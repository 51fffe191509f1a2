"""The report on a device has every part; what is wrong is said, and is its exit code."""

from __future__ import annotations

import pytest

from . import __main__ as command
from . import pages, tests_on_device

SAID = """..F.                                        [100%]
=== short test summary info ===
FAILED tests/gpu/test_memory.py::test_a - assert 1 == 2
ERROR tests/gpu/test_slots.py
1 failed, 3 passed, 2 skipped, 1 error in 4.21s
"""


def test_what_pytest_says_is_counted_and_named():
    found = tests_on_device.outcome("gpu", SAID)
    assert found.counts == {"failed": 1, "passed": 3, "skipped": 2, "error": 1}
    assert found.failed == (
        "tests/gpu/test_memory.py::test_a - assert 1 == 2",
        "tests/gpu/test_slots.py",
    )
    assert not found.is_good
    assert tests_on_device.outcome("cpu", "3 passed in 1.00s").is_good
    assert not tests_on_device.outcome("cpu", "").is_good


def test_folders_of_tests_are_there():
    chosen = (*tests_on_device.FOLDERS, *tests_on_device.QUICK)
    assert all((tests_on_device.REPOSITORY / "tests" / name).exists() for name in chosen)


def test_stages_stand_beside_what_they_handle():
    case = {
        "name": "room",
        "technique": "lpv",
        "size": (64, 36),
        "passes": {"march": 2.0, "sky": 0.5},
        "flying_ms": {"median": 10.0, "min": 8.0},
        "python_ms": {"median": 1.0},
        "counts": {"march": {"passes": 3, "invocations": 4_000_000, "nbytes": 6_000_000}},
    }
    page = pages.frames_page([case])
    assert "| room | lpv | 64x36 | 10 | 8 | 1 | 10% |" in page
    assert "| march | 2 | 3 | 6 | 4 | 3 | 2 |" in page
    assert "| sky | 0.5 | 0 | 0 | 0 | - | - |" in page


def test_images_too_far_apart_are_marked():
    page = pages.paths_page({"a lpv": {"direct": 0.02}}, {"a lpv": {"direct": 0.01}})
    assert "| a lpv: direct | 0.0200 | 0.010 | **over** |" in page


def test_a_device_that_is_not_there_is_one_message(tmp_path, capsys):
    assert command.main(["--adapter", "no such card", "-o", str(tmp_path / "page.md")]) == 2
    assert capsys.readouterr().err.startswith("error: ")
    assert not (tmp_path / "page.md").exists()


def test_failed_tests_are_the_exit_code(gpu, tmp_path, monkeypatch):
    bad = tests_on_device.outcome("gpu", SAID)
    monkeypatch.setattr(tests_on_device, "run", lambda *asked: bad)
    monkeypatch.setattr(command, "both_paths", lambda chosen: ({}, {}))
    monkeypatch.setattr(command, "frame_cases", lambda is_quick: [])
    path = tmp_path / "page.md"
    assert command.main(["--quick", "-o", str(path)]) == 1
    text = path.read_text("utf-8")
    assert gpu.info.name in text and "max-storage-buffers-per-shader-stage" in text
    assert "tests/gpu/test_memory.py::test_a" in text


@pytest.mark.slow
def test_the_whole_of_it_quickly(gpu, tmp_path):
    path = tmp_path / "page.md"
    assert command.main(["--quick", "--adapter", gpu.info.name, "-o", str(path)]) == 0
    text = path.read_text("utf-8")
    for part in ("## Device", "## Tests", "## Both code paths", "## Frames", "Stages of atrium"):
        assert part in text
    assert text.count("11 passed") == 2
