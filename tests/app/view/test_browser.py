"""What a browser may say, the link, and (slow) a real server spoken to in its own protocol."""

from __future__ import annotations

import asyncio
import io
import json
import socket
import subprocess
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.app.view.browser import FILES, link_to, say_where
from airlight.app.view.guard import bound_socket
from airlight.app.view.page import web_text
from small_viewer import SCENE, served


def test_the_link_carries_the_token():
    with bound_socket("", 0) as bound:
        port = bound.getsockname()[1]
        assert link_to(bound, "tok") == f"http://127.0.0.1:{port}/tok/"


def test_listening_to_others_warns_and_loopback_does_not(capsys, monkeypatch):
    monkeypatch.delenv("SSH_CONNECTION", raising=False)
    say_where("http://host:8900/tok/", 8900, "0.0.0.0")
    said = capsys.readouterr()
    assert said.out == "http://host:8900/tok/\n"
    assert "warning: served on 0.0.0.0: whoever gets the link can look and steer" in said.err
    say_where("http://127.0.0.1:8900/tok/", 8900, "")
    assert "warning" not in capsys.readouterr().err
    monkeypatch.setenv("SSH_CONNECTION", "198.51.100.7 40000 198.51.100.8 22")
    say_where("http://127.0.0.1:8900/tok/", 8900, "")
    assert "ssh -N -L 8900:127.0.0.1:8900" in capsys.readouterr().err


def test_the_page_asks_for_nothing_from_elsewhere():
    for name in FILES:
        text = web_text(name).replace("http://www.w3.org/2000/svg", "")  # a name, not an address
        assert "http:" not in text and "https:" not in text and "//cdn" not in text
    page = web_text("index.html")
    # What wraps the socket stands before what opens it.
    assert page.index('src="page.js"') < page.index('src="renderview-client.js"')


@pytest.mark.needs("uvicorn")
def test_a_port_in_use_ends_with_2_and_one_line(capsys):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = str(other.getsockname()[1])
        assert run(["view", str(SCENE), "--in", "browser", "--port", port, "--no-open"]) == 2
    said = capsys.readouterr()
    assert f"error: port {port} is in use" in said.err
    assert said.out == ""


@pytest.fixture(scope="module")
def server():
    """(link, process) of a viewer served by the real command."""
    process = served(subprocess.PIPE)
    assert process.stdout is not None
    yield process.stdout.readline().strip(), process
    process.terminate()
    assert process.wait(20) == 0


class Browser:
    """A websocket client that speaks as renderview-client.js does."""

    def __init__(self, link: str) -> None:
        self.link = link.replace("http:", "ws:")
        self.is_active: bool | None = None

    async def __aenter__(self) -> Browser:
        import websockets

        for _ in range(50):  # the server may be starting
            try:
                self.socket = await websockets.connect(self.link)
                return self
            except OSError:
                await asyncio.sleep(0.2)
        raise TimeoutError(self.link)

    async def __aexit__(self, *error: object) -> None:
        await self.socket.close()

    async def say(self, type: str, **fields: object) -> None:
        await self.socket.send(json.dumps({"type": type, "timestamp": time.time(), **fields}))

    async def resize(self, width: int, height: int) -> None:
        await self.say("resize", width=width, height=height, pwidth=width, pheight=height, ratio=1)

    async def drag(self, dx: int) -> None:
        at = {"x": 400, "y": 100, "buttons": [1], "modifiers": [], "ntouches": 0, "touches": {}}
        await self.say("pointer_down", **at, button=1)
        await self.say("pointer_move", **{**at, "x": 400 + dx}, button=0)
        await self.say("pointer_up", **{**at, "x": 400 + dx, "buttons": []}, button=1)

    async def image(self, timeout_s: float = 60.0) -> np.ndarray:
        """The next image, confirmed."""
        from PIL import Image

        async with asyncio.timeout(timeout_s):
            while True:
                message = json.loads(await self.socket.recv())
                if message["type"] == "active":
                    self.is_active = message["value"]
                if message["type"] == "framebufferdata":
                    break
            data = await self.socket.recv()
        await self.say("_framefeedback", index=message["index"], timestamp=message["timestamp"])
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)

    async def settled(self, shape: tuple[int, int]) -> np.ndarray:
        """An image of (height, width) that shows the scene, right of the panel."""
        for _ in range(200):
            shown = await self.image()
            if shown.shape[:2] == shape and shown[:, 340:].std() > 5.0:
                return shown[:, 340:]
        raise AssertionError("no such image came")


async def wait_for_change(browser: Browser, before: np.ndarray) -> np.ndarray:
    for _ in range(200):
        shown = (await browser.image())[:, 340:]
        if shown.shape == before.shape and np.abs(shown - before).mean() > 2.0:
            return shown
    raise AssertionError("the image did not change")


@pytest.mark.needs("uvicorn", "websockets")
@pytest.mark.slow
def test_a_wrong_token_is_refused_by_the_real_server(server):
    import websockets

    link, _ = server

    async def knock() -> None:
        async with Browser(link):
            pass
        with pytest.raises(websockets.InvalidStatus, match="403"):
            await websockets.connect("/".join(link.replace("http:", "ws:").split("/")[:3]) + "/x/")

    asyncio.run(knock())
    assert urllib.request.urlopen(link).status == 200
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(link[:-3] + "/")


@pytest.mark.needs("uvicorn", "websockets")
@pytest.mark.slow
def test_a_drag_changes_the_streamed_image(server):
    async def look() -> None:
        async with Browser(server[0]) as browser:
            await browser.resize(640, 300)
            before = await browser.settled((300, 640))
            assert browser.is_active is not False
            await browser.drag(60)
            await wait_for_change(browser, before)

    asyncio.run(look())


@pytest.mark.needs("uvicorn", "websockets")
@pytest.mark.slow
def test_a_browser_gone_mid_stream_and_nonsense_leave_the_server_well(server):
    link, process = server

    async def vanish() -> None:
        async with Browser(link) as browser:
            await browser.resize(600, 280)
            await browser.image()
            await browser.drag(30)
            browser.socket.transport.abort()  # no goodbye
        async with Browser(link) as browser:
            await browser.socket.send("{not json")
            await browser.socket.send(b"\x00\x01")
            await browser.say("resize", pwidth=0, pheight=0, width=0, height=0, ratio=1)
            await browser.say("close")
            await browser.say("no such event")
            await browser.resize(620, 280)
            await browser.settled((280, 620))

    asyncio.run(vanish())
    assert process.poll() is None


@pytest.mark.needs("uvicorn", "websockets")
@pytest.mark.slow
def test_a_second_viewer_looks_on_and_then_takes_over(server):
    async def together() -> None:
        async with Browser(server[0]) as first, Browser(server[0]) as second:
            # Whoever came first steers.
            await first.resize(640, 300)
            before = await first.settled((300, 640))
            await second.resize(620, 280)  # counts for nothing yet
            assert (await second.settled((300, 640))).shape == before.shape
            assert second.is_active is False
            await first.drag(-60)
            await wait_for_change(first, before)
            await first.socket.close()  # now the second steers, and its size counts
            assert (await second.settled((280, 620))).shape == (280, 280, 3)
            assert second.is_active is True

    asyncio.run(together())
