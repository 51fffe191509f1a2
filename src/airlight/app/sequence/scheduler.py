"""Whether a dask scheduler is at an address, found out before `distributed` speaks to it.

`distributed` believes whatever lengths a peer sends, and asks for that much memory; an address it
cannot read raises in a thread of its own, seconds after its user has been told. So the address is
read first, and the first words of the server behind it, no further than such words can go.
"""

from __future__ import annotations

import socket
import struct
from time import monotonic, sleep

from ...errors import SettingsError

_LONGEST_GREETING = 1 << 16  # bytes; schedulers send about 130
_GREETS_BY = b"pickle-protocol"  # a key that every version of the handshake has
_RETRY_S = 0.1


def check_address(address: str) -> None:
    """Raise SettingsError unless `distributed` knows how to speak to addresses like this one."""
    try:
        _place(address)
    except (ValueError, ImportError, RuntimeError) as error:
        raise SettingsError(
            f"--farm {address} is no address of a dask scheduler ({error})",
            remedy="Give the one that `dask scheduler` shows: tcp://HOST:PORT.",
        ) from None


def check_scheduler(address: str, answer_s: float) -> None:
    """Raise SettingsError unless a dask server greets at `address` within `answer_s` seconds.

    One that is only just starting is waited for. Schemes other than tcp are left to `distributed`.
    """
    check_address(address)
    scheme, host, port = _place(address)
    if scheme != "tcp":
        return
    # Nothing there, and something else there, are two mistakes with two remedies.
    deadline_s = monotonic() + answer_s
    try:
        with _connected(host, port, deadline_s) as connection:
            greets = _GREETS_BY in _greeting(connection, deadline_s)
    except (OSError, OverflowError):  # OverflowError: no port has such a number
        raise no_answer(address) from None
    if not greets:
        raise SettingsError(
            f"what answers at {address} is no dask scheduler",
            remedy="Give the address that `dask scheduler` shows; its dashboard has another.",
        )


def no_answer(address: str) -> SettingsError:
    """The error of an address where nothing of use can be reached."""
    return SettingsError(
        f"no dask scheduler answers at {address}",
        remedy="Start one by `dask scheduler`, and workers by `dask worker ADDRESS`.",
    )


def _place(address: str) -> tuple[str, str, int]:
    """(scheme, host, port); host and port are empty and 0 for schemes that may have none.

    Raises ValueError for an address that cannot be, ImportError and RuntimeError for a scheme that
    lacks a package here.
    """
    from distributed.comm.addressing import parse_address, parse_host_port
    from distributed.comm.registry import get_backend

    # `distributed` itself reads the address; what it cannot, it says here.
    scheme, location = parse_address(address)
    get_backend(scheme)
    if scheme == "inproc":
        return scheme, "", 0
    host, port = parse_host_port(location)
    if not host or not 0 < port < 1 << 16:
        raise ValueError("it lacks a host, or a port from 1 to 65535")
    return scheme, host, port


def _connected(host: str, port: int, deadline_s: float) -> socket.socket:
    """A connection; one that is refused is tried again until the deadline. Raises OSError."""
    while True:
        try:
            return socket.create_connection((host, port), _left(deadline_s))
        except ConnectionRefusedError:
            if monotonic() + _RETRY_S > deadline_s:
                raise
            sleep(_RETRY_S)


def _greeting(connection: socket.socket, deadline_s: float) -> bytes:
    """What a dask server says to whoever connects; empty where no such thing is said in time.

    It is a length (unsigned, 64 bits, little endian) and as many bytes.
    """
    try:
        # A length that no greeting has is some other server's first bytes.
        (length,) = struct.unpack("<Q", _received(connection, 8, deadline_s))
        is_short = length <= _LONGEST_GREETING
        return _received(connection, length, deadline_s) if is_short else b""
    except (struct.error, TimeoutError, ConnectionError):
        return b""


def _received(connection: socket.socket, count: int, deadline_s: float) -> bytes:
    """`count` bytes, or fewer where the connection ends. Raises TimeoutError, OSError."""
    received = b""
    while len(received) < count:
        # Each part may take the rest of the time for all.
        connection.settimeout(_left(deadline_s))
        part = connection.recv(count - len(received))
        if not part:
            break
        received += part
    return received


def _left(deadline_s: float) -> float:
    left = deadline_s - monotonic()
    if left <= 0:
        raise TimeoutError
    return left
