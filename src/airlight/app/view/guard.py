"""Who may see the viewer that is served: whoever has the token, and on loopback only.

The token is the first part of the path, so that everything the page asks for carries it. A
browser must have asked for this very machine (`Host`; a name that leads here by somebody's DNS is
refused) and from the viewer's own page (`Origin`).
"""

from __future__ import annotations

import hmac
import ipaddress
import re
import secrets
import socket
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from ...errors import AirlightError

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]

LOOPBACK = "127.0.0.1"
REFUSAL = (
    "This is an airlight viewer, but the link lacks its token or has an old one. "
    "Open the link that `airlight view` printed last.\n"
)
FOREIGN = (
    "This is an airlight viewer, but it was asked for under a name that is not this machine's, or "
    "by another site's page. Open the link that `airlight view` printed.\n"
)
_HEADERS = [
    (b"cache-control", b"no-store"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
    (
        b"content-security-policy",
        b"default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
        b"script-src 'self' 'unsafe-inline'; connect-src 'self' ws: wss:; frame-ancestors 'none'",
    ),
]
_WRONG_TOKEN = 4403  # a close code of our own


def new_token() -> str:
    """A secret that fits into an address: 128 random bits."""
    return secrets.token_urlsafe(16)


class Guard:
    """An ASGI application that passes only requests with the token on to `app`.

    They must be for this machine, as `is_own` says of a host's name, and from its own page.
    """

    def __init__(self, app: App, token: str, listen: str = "") -> None:
        self.app, self.token, self.listen = app, token, listen

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Handle one connection."""
        # What is no connection of a browser, such as the server's own start, goes on.
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        # The path begins with the token, compared in constant time; the rest goes on to the page.
        _, given, rest = (*str(scope["path"]).split("/", 2), "", "")[:3]
        if not hmac.compare_digest(given.encode(), self.token.encode()):
            await _refuse(scope, send, REFUSAL)
        elif not _is_from_own_page(scope, self.listen):
            await _refuse(scope, send, FOREIGN)
        # Steering goes by the socket; all else on the page is only read.
        elif scope["type"] == "websocket":
            await self.app({**scope, "path": f"/{rest}"}, receive, send)
        elif scope.get("method") not in ("GET", "HEAD"):
            await _answer(send, 405, "Only GET.\n")
        # The page's links are relative, so its address ends in a slash.
        elif str(scope["path"]) == f"/{self.token}":
            await _answer(send, 308, "", (b"location", f"/{self.token}/".encode()))
        else:
            await self.app({**scope, "path": f"/{rest}"}, receive, _with_headers(send))


async def _refuse(scope: Message, send: Send, text: str) -> None:
    if scope["type"] == "websocket":
        reason = "wrong token" if text == REFUSAL else "another site's page"
        await send({"type": "websocket.close", "code": _WRONG_TOKEN, "reason": reason})
    else:
        await _answer(send, 403, text)


def _is_from_own_page(scope: Message, listen: str) -> bool:
    """Whether a request names one host, ours, and comes from no other site's page."""
    headers = [(bytes(name).lower(), bytes(value)) for name, value in scope.get("headers", ())]
    hosts = [value for name, value in headers if name == b"host"]
    origins = [value for name, value in headers if name == b"origin"]
    # Headers may come twice, which proxies and servers read differently.
    if len(hosts) != 1 or len(origins) > 1:
        return False
    # A name that was rebound to this machine, and a page of another site, are both refused.
    host = hosts[0].decode("latin-1").lower()
    if not is_own(_without_port(host), listen):
        return False
    return not origins or origins[0].decode("latin-1").lower() in (
        f"http://{host}",
        f"https://{host}",
    )


def _without_port(host: str) -> str:
    """The name or address in a Host header; empty where it is none."""
    found = re.fullmatch(r"(?:\[([0-9a-f:.%]+)\]|([^:\[\]/@]+))(?::\d{1,5})?", host)
    return (found[1] or found[2]) if found else ""


def is_own(host: str, listen: str) -> bool:
    """Whether a browser that asks for `host` means this machine, which serves on `listen`.

    On loopback: localhost and loopback addresses, through a tunnel, too. Served to others: any
    address in numbers, since no DNS is asked for one, and the names of this machine.
    """
    # Loopback can only be this machine.
    if host == "localhost" or is_loopback(host or "none"):
        return True
    if is_loopback(listen):
        return False
    try:
        return bool(ipaddress.ip_address(host))
    except ValueError:
        name = socket.gethostname().lower()
        return host in {name, f"{name}.local", socket.getfqdn().lower(), listen.lower()}


async def _answer(send: Send, status: int, text: str, *headers: tuple[bytes, bytes]) -> None:
    # Even refusals have the headers that keep pages of others out.
    kind = (b"content-type", b"text/plain; charset=utf-8")
    start = {"type": "http.response.start", "status": status, "headers": [kind, *headers]}
    await _with_headers(send)(start)
    await send({"type": "http.response.body", "body": text.encode()})


def _with_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", []), *_HEADERS]}
        await send(message)

    return sent


def is_loopback(address: str) -> bool:
    """Whether only this machine can reach the address."""
    # An empty address and localhost are loopback without a look-up.
    if address in ("", "localhost"):
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def bound_socket(address: str, port: int) -> socket.socket:
    """A listening socket; port 0 takes a free one. Raises AirlightError saying what to do."""
    # Loopback, unless another address is asked for.
    host = address if address not in ("", "localhost") else LOOPBACK
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except (OSError, UnicodeError):
        raise AirlightError(
            f"'{address}' is no address of this machine", remedy="Leave --listen out for loopback"
        ) from None
    # The port is taken at once, so that a link that is said leads here.
    made = socket.socket(family, kind, protocol)
    try:
        # Not SO_REUSEADDR on Windows: there it would share a port that is in use.
        if hasattr(socket, "SO_REUSEPORT"):
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(place)
        made.listen(16)
    except OSError as error:
        made.close()
        raise _refused(error, host, port) from None
    return made


def _refused(error: OSError, host: str, port: int) -> AirlightError:
    import errno

    if error.errno == errno.EADDRINUSE:
        return AirlightError(
            f"port {port} is in use", remedy="Choose another with --port, or leave it out"
        )
    if error.errno == errno.EACCES:
        return AirlightError(f"port {port} is not allowed", remedy="Choose one above 1023")
    return AirlightError(
        f"cannot serve on {host}, port {port} ({error.strerror or error})",
        remedy="Leave --listen out for loopback",
    )
