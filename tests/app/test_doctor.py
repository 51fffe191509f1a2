"""`airlight doctor`: which adapter and why, what is missing, and how to get it."""

from __future__ import annotations

import json
from importlib import metadata

import pytest

from airlight.app import cli, doctor
from airlight.gpu import device
from airlight.gpu.device import AdapterInfo

GPU = AdapterInfo("Fast Card", "DiscreteGPU", "Vulkan", "drv 1", "maker", 0)
CPU = AdapterInfo("llvmpipe", "CPU", "Vulkan", "Mesa", "Mesa", 1)


@pytest.fixture
def machine(monkeypatch):
    """A machine with the given adapters."""

    def with_adapters(*found: AdapterInfo) -> None:
        monkeypatch.setattr(device, "adapters", lambda: list(found))

    return with_adapters


def test_the_best_adapter_is_used_and_why_is_said(machine, capsys):
    machine(GPU, CPU)
    assert cli.run(["doctor"]) == 0
    out = capsys.readouterr().out
    assert "  * Fast Card: DiscreteGPU, Vulkan, drv 1\n" in out
    assert "    llvmpipe: CPU, Vulkan, Mesa\n" in out
    assert "  used: Fast Card; why: DiscreteGPU comes before CPU\n" in out
    assert "AIRLIGHT_ADAPTER=auto" in out


def test_without_a_cache_folder_all_else_is_said(machine, capsys, monkeypatch):
    machine(GPU)
    monkeypatch.setenv("AIRLIGHT_CACHE", "~nosuchuser/x")
    assert cli.run(["doctor"]) == 2
    out, err = capsys.readouterr()
    assert "  used: Fast Card; " in out
    assert "  cache: none: AIRLIGHT_CACHE: there is no home folder for the cache '~nosuc" in out
    (line,) = err.splitlines()
    assert line.startswith("error: AIRLIGHT_CACHE: there is no home folder for the cache")


def test_the_switch_chooses(machine, capsys, monkeypatch):
    machine(GPU, CPU)
    monkeypatch.setenv("AIRLIGHT_ADAPTER", "cpu")
    assert cli.run(["doctor", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["used"] == "llvmpipe"
    assert [info["name"] for info in told["adapters"]] == ["Fast Card", "llvmpipe"]
    assert told["switches"]["AIRLIGHT_ADAPTER"] == "cpu"


@pytest.mark.parametrize(
    ("adapter", "switch", "expected"),
    [
        (GPU, "", "gpu"),
        (CPU, "auto", "cpu"),
        (GPU, "cpu", "cpu"),
        (CPU, "GPU", "gpu"),
    ],
)
def test_the_code_paths_are_said(machine, capsys, monkeypatch, adapter, switch, expected):
    machine(adapter)
    monkeypatch.setenv("AIRLIGHT_PATHS", switch)
    assert cli.run(["doctor"]) == 0
    out = capsys.readouterr().out
    assert f"  code paths: {expected}\n" in out
    assert f"  AIRLIGHT_PATHS={switch or 'auto'}  " in out


def test_code_paths_that_there_are_not_are_exit_2_after_the_whole_report(
    machine, capsys, monkeypatch
):
    machine(CPU)
    monkeypatch.setenv("AIRLIGHT_PATHS", "both")
    assert cli.run(["doctor"]) == 2
    out, err = capsys.readouterr()
    assert "AIRLIGHT_PATHS=both" in out
    assert err == (
        "error: AIRLIGHT_PATHS: there are no paths 'both'. "
        "Use auto (those made for the adapter), gpu or cpu\n"
    )


def test_no_driver_is_exit_2_with_the_remedy_after_the_whole_report(machine, capsys):
    machine()
    assert cli.run(["doctor"]) == 2
    out, err = capsys.readouterr()
    assert "Graphics adapters\n  none\n" in out
    assert "Switches" in out
    assert err.startswith("error: no graphics driver was found. Install a Vulkan driver")
    assert "mesa-vulkan-drivers" in err


def test_a_wish_that_nothing_grants_is_exit_2(machine, capsys):
    machine(CPU)
    assert cli.run(["doctor", "--adapter", "gpu"]) == 2
    assert "no adapter matches 'gpu'; there is llvmpipe (CPU)" in capsys.readouterr().err


def test_missing_extras_say_how_to_get_them(machine, capsys, monkeypatch):
    machine(CPU)
    monkeypatch.setattr(
        doctor.metadata,
        "requires",
        lambda _: [
            "numpy>=1.26",
            'mitsuba>=3.6; extra == "reference"',
            "glfw>=2; extra == 'view'",
        ],
    )
    monkeypatch.setattr(doctor, "_installed_version", {"mitsuba": None, "glfw": "2.8"}.get)
    assert cli.run(["doctor"]) == 0
    out = capsys.readouterr().out
    assert '  reference: mitsuba missing; pip install "airlight[reference]"' in out
    assert "  view: glfw 2.8 (the viewer, in a window or a browser)\n" in out


def test_without_installed_metadata_there_are_no_extras(monkeypatch):
    def missing(_):
        raise metadata.PackageNotFoundError

    monkeypatch.setattr(doctor.metadata, "requires", missing)
    assert doctor.extras() == {}


def test_a_chosen_llvm_is_reported(tmp_path):
    library = tmp_path / "libLLVM-19.so"
    library.write_bytes(b"")
    told = doctor.llvm_facts({"DRJIT_LIBLLVM_PATH": str(library)})
    assert told["library"] == str(library)
