"""Nothing without the token, nothing beyond loopback unasked, and clear words about ports."""

from __future__ import annotations

import asyncio
import socket

import pytest

from airlight.app.view.guard import (
    FOREIGN,
    LOOPBACK,
    REFUSAL,
    Guard,
    bound_socket,
    is_loopback,
    new_token,
)
from airlight.errors import AirlightError

TOKEN = "s3cret-token"


def ask(
    path: str,
    kind: str = "http",
    method: str = "GET",
    *,
    listen: str = "",
    headers: tuple[tuple[bytes, bytes], ...] = ((b"host", b"127.0.0.1:8900"),),
) -> tuple[list[dict], list[str]]:
    """What was sent back, and the paths that came through."""
    sent: list[dict] = []
    through: list[str] = []

    async def app(scope, receive, send):
        through.append(scope["path"])
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message):
        sent.append(message)

    scope = {"type": kind, "path": path, "method": method, "headers": headers}
    asyncio.run(Guard(app, TOKEN, listen)(scope, None, send))
    return sent, through


@pytest.mark.parametrize(
    "path",
    ["/", "/index.html", "/s3cret-toke/", "/S3CRET-TOKEN/", "//", "", f"/x/{TOKEN}/", "/sécret/"],
)
def test_without_the_token_nothing_comes_through(path):
    sent, through = ask(path)
    assert through == []
    assert sent[0]["status"] == 403
    assert sent[1]["body"].decode() == REFUSAL
    closed, through = ask(path, kind="websocket")
    assert through == []
    assert [message["type"] for message in closed] == ["websocket.close"]


def test_with_the_token_the_rest_of_the_path_comes_through():
    assert ask(f"/{TOKEN}/")[1] == ["/"]
    assert ask(f"/{TOKEN}/renderview.js")[1] == ["/renderview.js"]
    assert ask(f"/{TOKEN}/", kind="websocket")[1] == ["/"]
    assert ask("", kind="lifespan")[1] == [""]


def test_the_bare_token_is_led_to_its_folder():
    sent, through = ask(f"/{TOKEN}")
    assert through == []
    assert sent[0]["status"] == 308
    assert (b"location", f"/{TOKEN}/".encode()) in sent[0]["headers"]


def headers_of(*given: str) -> tuple[tuple[bytes, bytes], ...]:
    pairs = (text.split(" ", 1) for text in given)
    return tuple((name.encode(), value.encode("latin-1")) for name, value in pairs)


@pytest.mark.parametrize(
    "given",
    [
        ["host localhost:8900"],
        ["host 127.0.0.1"],
        ["host [::1]:8900"],
        ["host LocalHost:9000"],
        ["host localhost:8900", "origin http://localhost:8900"],
        ["host localhost", "origin https://localhost"],
    ],
)
@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_the_viewers_own_page_comes_through(given, kind):
    assert ask(f"/{TOKEN}/", kind, headers=headers_of(*given))[1] == ["/"]


@pytest.mark.parametrize(
    "given",
    [
        [],
        ["host evil.example:8900"],
        ["host localhost.evil.example"],
        ["host 10.0.0.7:8900"],
        ["host localhost", "host evil.example"],
        ["host evil.example@localhost"],
        ["host "],
        ["host localhost:8900", "origin http://evil.example"],
        ["host localhost:8900", "origin http://localhost:9999"],
        ["host localhost:8900", "origin null"],
        ["host [::1"],
        ["host localhost:8900/"],
        ["host localhost", "origin http://localhost", "origin http://evil.example"],
    ],
)
def test_other_names_and_other_sites_pages_do_not(given):
    sent, through = ask(f"/{TOKEN}/", headers=headers_of(*given))
    assert through == []
    assert (sent[0]["status"], sent[1]["body"].decode()) == (403, FOREIGN)
    closed, through = ask(f"/{TOKEN}/", "websocket", headers=headers_of(*given))
    assert through == []
    assert [message["type"] for message in closed] == ["websocket.close"]


def test_served_to_others_it_has_addresses_and_the_machines_names():
    name = socket.gethostname().lower()
    for host in ("192.0.2.7:8900", "[2001:db8::1]:8900", name, f"{name}.local:8900", "localhost"):
        assert ask(f"/{TOKEN}/", headers=headers_of(f"host {host}"), listen="0.0.0.0")[1] == ["/"]
    for host in ("evil.example", f"{name}.evil.example"):
        assert ask(f"/{TOKEN}/", headers=headers_of(f"host {host}"), listen="0.0.0.0")[1] == []


def test_only_reading_is_allowed():
    sent, through = ask(f"/{TOKEN}/", method="POST")
    assert through == []
    assert sent[0]["status"] == 405


def test_every_answer_keeps_the_token_to_itself():
    for path in (f"/{TOKEN}/", "/wrong/"):
        headers = dict(ask(path)[0][0]["headers"])
        assert headers[b"referrer-policy"] == b"no-referrer"
        assert headers[b"cache-control"] == b"no-store"
        assert b"frame-ancestors 'none'" in headers[b"content-security-policy"]


def test_tokens_are_long_and_never_the_same():
    assert len({new_token() for _ in range(50)}) == 50
    assert len(new_token()) >= 22


def test_what_is_loopback():
    assert all(is_loopback(a) for a in ("", "localhost", "127.0.0.1", "127.3.2.1", "::1"))
    assert not any(is_loopback(a) for a in ("0.0.0.0", "::", "10.0.0.7", "example.org"))


def test_only_loopback_is_served_unless_asked():
    with bound_socket("", 0) as bound:
        assert bound.getsockname()[0] == LOOPBACK
        assert bound.getsockname()[1] > 1023


def test_a_port_in_use_is_said():
    with socket.socket() as other:
        other.bind((LOOPBACK, 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(AirlightError, match=f"port {port} is in use. Choose another"):
            bound_socket("", port)


@pytest.mark.parametrize("address", ["no such host.invalid", "256.1.1.1", "203.0.113.9"])
def test_an_address_of_another_machine_is_refused(address):
    with pytest.raises(AirlightError, match=r"Leave --listen out"):
        bound_socket(address, 0)
