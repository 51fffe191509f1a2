"""The set-up script: what it says where Python, venv or a graphics driver is missing.

It runs in a copy of the folder, with a PATH that holds a few tools and pretended commands.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from airlight.reference.mitsuba_llvm import find_llvm

REPOSITORY = Path(__file__).parents[1]
TOOLS = ("sh", "sed", "dirname", "cksum", "cat", "uname", "mktemp", "tail", "rm", "env")

pytestmark = pytest.mark.skipif(os.name != "posix", reason="a POSIX shell script")


class Machine:
    """A folder with `run` in it, and a PATH of its own."""

    def __init__(self, root: Path) -> None:
        self.folder, self.path = root / "airlight", root / "bin"
        self.folder.mkdir()
        self.path.mkdir()
        for name in ("run", "pyproject.toml"):
            shutil.copy(REPOSITORY / name, self.folder / name)
        for tool in TOOLS:
            (self.path / tool).symlink_to(str(shutil.which(tool)))
        self.pretend("id", "echo 1000")  # not root

    def pretend(self, name: str, script: str, folder: Path | None = None) -> None:
        """Put a command in its place."""
        path = (folder or self.path) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """./run ARGUMENTS, without a terminal."""
        return subprocess.run(
            ["/bin/sh", str(self.folder / "run"), *arguments],
            env={"PATH": str(self.path), "HOME": str(self.folder)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )


@pytest.fixture
def machine(tmp_path) -> Machine:
    return Machine(tmp_path)


def installed(machine: Machine, *, adapters: int) -> None:
    """A .venv that is up to date, with `airlight` pretended, and this many adapters."""
    status = 0 if adapters else 3
    machine.pretend(
        "python",
        'case "$*" in\n'
        f"  *adapters*) exit {status} ;;\n"
        '  "-m airlight"*) echo "airlight $*" >&2 ;;\n'
        "esac",
        machine.folder / ".venv" / "bin",
    )
    state = subprocess.run(
        ["cksum", "pyproject.toml"], cwd=machine.folder, capture_output=True, text=True, check=True
    ).stdout.strip()
    stamp = machine.folder / ".venv" / "airlight-installed-test"
    stamp.write_text(f"{state} {machine.folder}\n")


def test_help_says_what_there_is(machine):
    done = machine.run()
    assert done.returncode == 0
    assert "./run demo" in done.stdout
    assert "set -eu" not in done.stdout


def test_an_unknown_command(machine):
    done = machine.run("nonsense")
    assert done.returncode == 2
    assert done.stderr.endswith("error: unknown command 'nonsense'\n")


def test_no_python(machine):
    done = machine.run("demo")
    assert done.returncode == 2
    assert "error: no Python 3.11 or newer was found.\n" in done.stderr


def test_an_old_python_is_named(machine):
    machine.pretend("python3", 'case "$1" in --version) echo Python 3.9.2 ;; *) exit 1 ;; esac')
    machine.pretend("apt-get", "exit 1")
    done = machine.run("demo")
    assert done.returncode == 2
    assert "was found (Python 3.9.2 is too old)." in done.stderr
    assert "Install one: sudo apt-get install python3 python3-venv" in done.stderr


def test_a_python_without_venv(machine):
    machine.pretend(
        "python3", f'case "$*" in *ensurepip*) exit 1 ;; *) exec {sys.executable} "$@" ;; esac'
    )
    done = machine.run("demo")
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    assert done.returncode == 2
    assert "cannot make virtual environments" in done.stderr
    assert f"Type: sudo apt-get install {version}-venv" in done.stderr


def test_with_an_adapter_nothing_is_installed(machine):
    installed(machine, adapters=1)
    machine.pretend("apt-get", "echo apt-get ran >&2")
    done = machine.run("demo", "--samples", "1")
    assert done.returncode == 0, done.stderr
    assert "apt-get ran" not in done.stderr
    assert "-m airlight render builtin:atrium -o atrium.png --samples 1" in done.stderr
    assert done.stdout == f"{machine.folder}/atrium.png\n"


@pytest.mark.parametrize(
    ("manager", "advice"),
    [
        ("apt-get", "sudo apt-get update && sudo apt-get install mesa-vulkan-drivers libvulkan1"),
        ("dnf", "sudo dnf install mesa-vulkan-drivers vulkan-loader"),
        ("pacman", "sudo pacman -S vulkan-swrast vulkan-icd-loader"),
        ("zypper", "sudo zypper install libvulkan_lvp libvulkan1"),
        ("other", "install Mesa's software Vulkan driver (lavapipe) with your package manager"),
    ],
)
def test_without_an_adapter_and_without_root_it_says_what_to_type(machine, manager, advice):
    installed(machine, adapters=0)
    machine.pretend(manager, "exit 0")
    done = machine.run("demo")
    assert done.returncode == 2
    assert "No graphics adapter was found" in done.stderr
    assert advice in done.stderr
    assert "render" not in done.stderr


def test_with_root_it_installs_the_driver_and_says_so(machine):
    installed(machine, adapters=0)
    machine.pretend("id", "echo 0")
    asked = machine.folder / "asked"
    machine.pretend(
        "apt-get",
        f'echo "$*" >>"{asked}"\n'
        'case "$1" in install) sed "s/exit 3/exit 0/" .venv/bin/python >.venv/bin/new\n'
        "cat .venv/bin/new >.venv/bin/python ;; esac",
    )
    done = machine.run("demo")
    assert done.returncode == 0, done.stderr
    assert asked.read_text().splitlines() == [
        "update",
        "install -y --no-install-recommends mesa-vulkan-drivers libvulkan1",
    ]
    assert "The software Vulkan driver is installed." in done.stderr
    assert "-m airlight render builtin:atrium" in done.stderr


@pytest.mark.needs(("bash",))
@pytest.mark.parametrize(("more", "has_llvm"), [((), False), (("-k", "fog", "--slow"), True)])
def test_continuous_integration_hides_a_libllvm_from_the_quick_suite(machine, more, has_llvm):
    machine.folder.joinpath(".ci").mkdir()
    shutil.copy(REPOSITORY / ".ci" / "run", machine.folder / ".ci" / "run")
    machine.pretend(
        "run",
        'if read -r line; then exit 9; fi\necho "$* CI=$CI LLVM=${DRJIT_LIBLLVM_PATH:-}"',
        machine.folder,
    )
    machine.path.joinpath("bash").symlink_to(str(shutil.which("bash")))
    own = machine.folder / "libLLVM-19.so"
    own.touch()
    done = subprocess.run(
        [machine.folder / ".ci" / "run", *more],
        env={"PATH": str(machine.path), "DRJIT_LIBLLVM_PATH": str(own)},
        input="a terminal's",
        capture_output=True,
        text=True,
        check=True,
    )
    checked, tested = done.stdout.splitlines()
    said = tested.rsplit("LLVM=", 1)[1]
    assert find_llvm({"DRJIT_LIBLLVM_PATH": said}) == (own if has_llvm else None)
    assert checked == f"check CI=true LLVM={said}"
    assert tested.startswith(" ".join(["test", *more, "CI=true"]))


def test_what_continuous_integration_calls_is_in_the_readme():
    readme = (REPOSITORY / "README.md").read_text("utf-8")
    lines = (REPOSITORY / ".ci" / "run").read_text("utf-8").splitlines()
    calls = [line.removesuffix(' "$@"') for line in lines if line.startswith("./run ")]
    assert calls == ["./run check", "./run test"]
    assert all(f"{call} " in readme for call in calls)


@pytest.mark.parametrize(
    ("command", "module", "extras"),
    [("fuzz", "fuzz", "test,vdb"), ("soak", "soak", "test"), ("gpu", "gpu_report", "test")],
)
def test_the_long_tests_are_commands(machine, command, module, extras):
    installed(machine, adapters=1)
    venv = machine.folder / ".venv"
    (venv / "airlight-installed-test").rename(venv / f"airlight-installed-{extras}")
    script = (venv / "bin" / "python").read_text()
    told = f'  "-m {module}"*) echo "$PYTHONPATH: $*" ;;\nesac'
    (venv / "bin" / "python").write_text(script.replace("esac", told))
    done = machine.run(command, "--minutes", "2")
    assert done.stdout == f"tests: -m {module} --minutes 2\n", done.stderr
