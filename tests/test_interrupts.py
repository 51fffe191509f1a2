"""Ctrl-C at any moment: nothing is said but 'interrupted', and the exit code is 130."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from airlight import interrupts

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

# Sends itself SIGINT when it first imports the module that its first argument names.
CHILD = """
import os, runpy, signal, sys
name = sys.argv.pop(1)
class At:
    def find_spec(self, wanted, path=None, target=None):
        if wanted == name:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, At())
runpy.run_module("airlight", run_name="__main__", alter_sys=True)
print("was not interrupted")
"""


@pytest.mark.parametrize(
    "module",
    [
        "airlight.app",
        "click",
        "airlight.app.cli",
        "airlight.scene",
        "numpy",
        "numpy._core",
        "airlight.app.scenes",
        "airlight.scene.builtin",
    ],
)
def test_an_interrupted_import_is_quiet(module):
    done = subprocess.run(
        [sys.executable, "-c", CHILD, module, "scenes"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 130, done
    assert done.stdout == ""
    assert done.stderr.strip() in ("", "interrupted")


@pytest.fixture(autouse=True)
def ctrl_c_is_heard():
    """Background jobs of a shell ignore Ctrl-C, and so would the processes started here."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def child(code: str) -> subprocess.CompletedProcess[str]:
    start = "import os, signal, time; from airlight import interrupts; interrupts.leave_quietly()\n"
    return subprocess.run(
        [sys.executable, "-c", start + code], capture_output=True, text=True, check=False
    )


def test_an_interrupt_that_became_another_error_is_one():
    done = child(
        "try:\n"
        "    with interrupts.taken_up():\n"
        "        try: os.kill(os.getpid(), signal.SIGINT)\n"
        "        except KeyboardInterrupt: raise ImportError('broken module')\n"
        "except KeyboardInterrupt: print('heard')"
    )
    assert (done.stdout, done.stderr) == ("heard\n", "")


def test_an_interrupt_that_was_lost_comes_again():
    done = child(
        "class Callback:\n"
        "    def __del__(self): os.kill(os.getpid(), signal.SIGINT)\n"
        "try:\n"
        "    with interrupts.taken_up():\n"
        "        Callback()\n"
        "        time.sleep(20)\n"
        "except KeyboardInterrupt: print('heard')\n"
    )
    assert (done.stdout, done.stderr) == ("heard\n", "")


def test_errors_without_an_interrupt_stay_what_they_are():
    done = child(
        "try:\n"
        "    with interrupts.taken_up(): raise ImportError('a')\n"
        "except ImportError: print('the same')"
    )
    assert done.stdout == "the same\n"


def test_a_program_that_uses_the_package_keeps_its_own_handler():
    # Another test of this process may have run the command, which keeps Ctrl-C until the end.
    def own(number, frame): ...

    before = signal.signal(signal.SIGINT, own)
    try:
        with interrupts.taken_up():
            assert signal.getsignal(signal.SIGINT) is own
    finally:
        signal.signal(signal.SIGINT, before)


def test_an_ignored_interrupt_stays_ignored():
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "from airlight import interrupts; interrupts.leave_quietly()\n"
        "print(signal.getsignal(signal.SIGINT) is signal.SIG_IGN)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"
