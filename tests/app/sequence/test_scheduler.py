"""What is no dask scheduler is found out in bounded time and memory, and said in one message."""

from __future__ import annotations

import os
import socket
import struct
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import pytest

from airlight.app.cli import run
from airlight.app.sequence import scheduler
from airlight.errors import SettingsError

GREETING = b"\x83\xabcompression\xc0\xafpickle-protocol\x05\xa6python\x93\x03\x0d\x01"


@contextmanager
def server(said, *, delay_s=0.0):
    """A server that says the same to everyone, and then nothing; its address."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        address = f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        kept = []

        def answer():
            while True:
                try:
                    connection, _ = listening.accept()
                except OSError:
                    return
                kept.append(connection)
                time.sleep(delay_s)
                connection.sendall(said)

        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        yield address
        listening.shutdown(socket.SHUT_RDWR)
        thread.join()
        for connection in kept:
            connection.close()


@pytest.fixture
def plain_addresses(monkeypatch):
    """Addresses are read without the package `distributed`."""

    def place(address):
        scheme, _, location = address.partition("://")
        host, _, port = location.partition(":")
        return scheme, host, int(port)

    monkeypatch.setattr(scheduler, "_place", place)


def framed(said):
    return struct.pack("<Q", len(said)) + said


def test_a_dask_server_is_known_by_its_greeting(plain_addresses):
    with server(framed(GREETING)) as address:
        scheduler.check_scheduler(address, 5.0)
    with server(framed(GREETING), delay_s=0.2) as address:
        scheduler.check_scheduler(address, 5.0)


@pytest.mark.parametrize(
    "said",
    [
        b"SSH-2.0-OpenSSH_9.7\r\n",  # as a length these are exbibytes
        b"220 mail.example.org ESMTP\r\n",
        b"\xff" * 8,
        framed(b"another protocol"),
        framed(GREETING)[:-1],  # never ends
        b"HTTP",
        b"",
    ],
)
def test_other_servers_are_one_message_in_time(plain_addresses, said):
    with server(said) as address:
        began = time.monotonic()
        with pytest.raises(SettingsError) as caught:
            scheduler.check_scheduler(address, 0.3)
        assert time.monotonic() - began < 5.0
    assert str(caught.value) == (
        f"what answers at {address} is no dask scheduler. Give the address that `dask scheduler` "
        "shows; its dashboard has another."
    )


def test_where_nobody_listens_there_is_no_answer(plain_addresses):
    with server(b"") as address:
        pass
    with pytest.raises(SettingsError, match=f"no dask scheduler answers at {address}"):
        scheduler.check_scheduler(address, 0.3)


def test_a_server_that_starts_late_is_waited_for(plain_addresses):
    with socket.socket() as late:
        late.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{late.getsockname()[1]}"

        def begin():
            time.sleep(0.3)
            late.listen()
            with late.accept()[0] as connection:
                connection.sendall(framed(GREETING))

        thread = threading.Thread(target=begin)
        thread.start()
        scheduler.check_scheduler(address, 10.0)
        thread.join()


@pytest.mark.needs("distributed")
@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("nonsense://x", "unknown address scheme 'nonsense'"),
        ("tcp://", "missing port number in address ''"),
        ("tcp://host", "missing port number in address 'host'"),
        ("tcp://host:port", "invalid literal for int"),
        ("tcp://host:99999", "it lacks a host, or a port from 1 to 65535"),
        ("tcp://:8786", "it lacks a host, or a port from 1 to 65535"),
        ("tcp://a:b:1", "invalid address"),
    ],
)
def test_what_is_no_address_is_refused_before_any_work(tmp_path, capsys, address, reason):
    output = tmp_path / "out"
    assert run(["sequence", "builtin:smoke", "-o", str(output), "--farm", address]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: --farm {address} is no address of a dask scheduler ({reason}")
    assert line.endswith(". Give the one that `dask scheduler` shows: tcp://HOST:PORT.")
    assert not output.exists()


_IN_CHILD = """
import sys, time
from airlight.app.sequence import farm
from airlight.app.sequence.plan import Plan
from airlight.errors import SettingsError
try:
    farm.farm_frames(sys.argv[1], None, None, [0], print, answer_s=0.5)
except SettingsError as error:
    print(error)
time.sleep(0.5)
"""


@pytest.mark.needs("distributed")
@pytest.mark.parametrize(
    ("said", "message"),
    [
        (b"SSH-2.0-OpenSSH_9.7\r\n", "what answers at {} is no dask scheduler. "),
        (framed(GREETING), "no dask scheduler answers at {}. "),  # speaks dask, then no more
    ],
)
def test_nothing_is_printed_after_the_message(said, message):
    with server(said) as address:
        began = time.monotonic()
        done = subprocess.run(
            [sys.executable, "-c", _IN_CHILD, address],
            capture_output=True,
            text=True,
            timeout=60,
            env=os.environ,
            check=False,
        )
    assert time.monotonic() - began < 15.0  # an end that was waited for took 20 s
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(message.format(address))
    assert len(done.stdout.splitlines()) == 1


@pytest.mark.needs("distributed")
def test_a_real_scheduler_is_known():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    started = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "distributed.cli.dask_scheduler",
            "--host",
            "127.0.0.1",
            "--port",
            str(port),
            "--no-dashboard",
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        scheduler.check_scheduler(f"tcp://127.0.0.1:{port}", 60.0)
    finally:
        started.kill()
        started.wait()
