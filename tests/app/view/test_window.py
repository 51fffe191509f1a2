"""The window: a clear refusal without a display, and (slow) real mouse and keys under Xvfb."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from airlight.app.cli import run
from small_viewer import OPTIONS, SCENE, box_share

PANEL_PX, SIZE = 340, (640, 320)
needs_a_desk = pytest.mark.needs("glfw", "imgui_bundle", ("Xvfb",), ("xdotool",))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have a display")
def test_without_a_display_the_browser_is_offered(monkeypatch, capsys):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert run(["view", str(SCENE)]) == 2
    said = capsys.readouterr().err
    assert "error: there is no display to open a window on. Use --in browser" in said


class Desk:
    """An X server of its own, with the viewer on it."""

    def __init__(self, scene: Path) -> None:
        self.x = subprocess.Popen(
            ["Xvfb", "-noreset", "-displayfd", "1", "-screen", "0", "800x500x24"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert self.x.stdout is not None
        self.display = f":{self.x.stdout.readline().strip()}"
        self.environment = {**os.environ, "DISPLAY": self.display}
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.viewer = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "airlight",
                "view",
                str(scene),
                "--size",
                f"{SIZE[0]}x{SIZE[1]}",
                "-t",
                "direct",
                *OPTIONS,
            ],
            env=self.environment,
            cwd=scene.parent,
            stderr=subprocess.PIPE,
            text=True,
        )

    def do(self, *words: object) -> None:
        command = ["xdotool", *map(str, words)]
        subprocess.run(command, env=self.environment, check=True, capture_output=True)

    def shot(self) -> np.ndarray:
        from PIL import ImageGrab

        return np.asarray(ImageGrab.grab(xdisplay=self.display).convert("RGB")).astype(int)

    def shown(self) -> np.ndarray:
        """What stands right of the panel."""
        return self.shot()[: SIZE[1], PANEL_PX : SIZE[0]]

    def until(self, is_so, what: str, seconds: float = 90.0) -> np.ndarray:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            assert self.viewer.poll() is None, self.viewer.communicate()[1]
            time.sleep(0.2)
            pixels = self.shown()
            if is_so(pixels):
                return pixels
        raise AssertionError(f"{what}: not within {seconds} s")

    def until_changed(self, before: np.ndarray, what: str, least: float = 3.0) -> np.ndarray:
        return self.until(lambda p: np.abs(p - before).mean() > least, what)

    def rested(self) -> np.ndarray:
        """The image once it hardly changes."""
        before = self.until(lambda p: p.std() > 15.0, "the scene is shown")
        for _ in range(60):
            time.sleep(0.5)
            after = self.shown()
            if np.abs(after - before).mean() < 0.2:
                return after
            before = after
        return before

    def close(self) -> None:
        self.viewer.terminate()
        self.viewer.wait(20)
        self.x.terminate()
        self.x.wait(20)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    scene = tmp_path_factory.mktemp("desk") / "box.toml"
    scene.write_text(SCENE.read_text())
    made = Desk(scene)
    made.scene = scene
    yield made
    made.close()


@needs_a_desk
@pytest.mark.slow
def test_a_drag_turns_the_image(desk):
    before = desk.rested()
    desk.do("mousemove", 480, 160, "mousedown", 1, "mousemove", 500, 160, "mousemove", 540, 165)
    desk.do("mouseup", 1)
    after = desk.until_changed(before, "the drag is seen")
    # Who drags to the right turns the box: it stays in the image, and shows another side.
    assert 0.5 < box_share(after) / box_share(before) < 2.0


@needs_a_desk
@pytest.mark.slow
def test_the_wheel_keys_and_sun(desk):
    before = desk.rested()
    desk.do("mousemove", 480, 160, "click", "--repeat", 3, 4)
    far, before = before, desk.until_changed(before, "the wheel is seen")
    assert box_share(desk.rested()) > 1.05 * box_share(far)  # up is nearer
    desk.do("keydown", "d")
    before = desk.until_changed(before, "flying is seen")
    desk.do("keyup", "d")
    before = desk.rested()
    desk.do("keydown", "ctrl", "mousedown", 1, "mousemove", 560, 120, "mouseup", 1, "keyup", "ctrl")
    after = desk.until_changed(before, "the turned sun is seen", least=1.0)
    assert box_share(after) == pytest.approx(box_share(before), rel=0.15)  # the camera stayed


@needs_a_desk
@pytest.mark.slow
def test_the_panel_takes_its_own_clicks_and_tab_hides_it(desk):
    before = desk.rested()
    desk.do("mousemove", 60, 290, "mousedown", 1, "mousemove", 90, 262, "mouseup", 1)  # the sun pad
    turned = desk.until_changed(before, "the sun pad turned the sun", least=1.0)
    # The sky, which no sun lights, stays where it is: the camera took nothing of that drag.
    assert np.abs(turned[:60] - before[:60]).mean() < 1.0
    panel = desk.shot()[: SIZE[1], :PANEL_PX]
    desk.do("mousemove", 480, 160, "key", "Tab")
    for _ in range(100):
        time.sleep(0.2)
        if np.abs(desk.shot()[: SIZE[1], :PANEL_PX] - panel).mean() > 20.0:
            break
    else:
        raise AssertionError("the panel stayed")
    desk.do("key", "Tab")


@needs_a_desk
@pytest.mark.slow
def test_a_saved_edit_is_shown_and_a_broken_one_said(desk):
    before = desk.rested()
    text = desk.scene.read_text()
    desk.scene.write_text(text.replace("[0.3, 0.4, 0.6]", "[0.9, 0.2, 0.1"))  # not closed
    time.sleep(3.0)
    assert np.abs(desk.rested() - before).mean() < 1.0
    desk.scene.write_text(text.replace("[0.3, 0.4, 0.6]", "[0.9, 0.2, 0.1]"))
    desk.until_changed(before, "the edit is seen", least=1.0)


@needs_a_desk
@pytest.mark.slow
def test_a_window_that_becomes_tiny_and_large_again(desk):
    desk.rested()
    found = subprocess.run(
        ["xdotool", "search", "--name", "airlight"],
        env=desk.environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    desk.do("windowsize", found[-1], 1, 1)
    time.sleep(2.0)
    desk.do("windowsize", found[-1], *SIZE)
    desk.until(lambda p: p.std() > 15.0, "the image is back")
    assert desk.viewer.poll() is None


@needs_a_desk
@pytest.mark.slow
def test_another_renderer_is_made_while_the_old_image_stays_live(desk):
    before = desk.rested()
    blank, seen = [], []

    def is_new(pixels):
        blank.append(pixels.std() < 15.0)
        seen.append(np.abs(pixels - before).mean())
        return seen[-1] > 3.0

    ball = '\n[[mesh]]\nshape = "sphere"\nscale = 0.8\ntranslate = [0.9, 0.4, 1.1]\n'
    desk.scene.write_text(desk.scene.read_text() + ball)
    desk.until(is_new, "the ball is seen")
    assert not any(blank)


@needs_a_desk
@pytest.mark.slow
def test_a_click_at_rest_opens_the_list_of_techniques(desk):
    desk.rested()
    desk.do("mousemove", 60, 104)
    time.sleep(0.5)
    before = desk.shot()[118:250, 15:150]
    desk.do("click", 1)
    end = time.monotonic() + 20.0
    while np.abs(desk.shot()[118:250, 15:150] - before).mean() < 8.0:
        assert time.monotonic() < end, "the list stayed shut"
        time.sleep(0.2)
    opened = desk.shot()[118:250, 15:150]
    assert np.abs(opened - before).mean() >= 8.0
    desk.do("mousemove", 480, 310, "click", 1)  # beside it: shut again
    time.sleep(1.0)


@needs_a_desk
@pytest.mark.slow
def test_ctrl_c_in_the_middle_of_frames_ends_it_quietly(desk):
    # The last test of this desk. Seen before: the window's texture gone when it was submitted.
    desk.rested()
    desk.do("keydown", "a")
    time.sleep(1.0)
    desk.viewer.send_signal(signal.SIGINT)
    said = desk.viewer.communicate(timeout=30)[1]
    assert desk.viewer.returncode == 0, said
    assert said.strip() == ""
