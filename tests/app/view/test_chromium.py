"""The viewer in a real browser: the page loads, and a drag changes what it shows."""

from __future__ import annotations

import io
import os
import shutil
import subprocess
import time

import numpy as np
import pytest

from airlight.app.view.page import web_text
from small_viewer import box_share, served

PANEL_PX = 340
CHROMIUMS = ("chromium", "chromium-browser", "google-chrome")

pytestmark = pytest.mark.needs("uvicorn", "playwright", CHROMIUMS)


@pytest.fixture(scope="module")
def page():
    """(page, link) with the viewer open in it."""
    from playwright import sync_api

    program = next(filter(None, map(shutil.which, CHROMIUMS)))
    viewer = served(subprocess.DEVNULL)
    assert viewer.stdout is not None
    link = viewer.stdout.readline().strip()
    # A container's root has no user namespaces for the browser's sandbox.
    flags = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=flags)
        context = browser.new_context(viewport={"width": 640, "height": 320}, has_touch=True)
        opened = context.new_page()
        for _ in range(50):
            try:
                opened.goto(link)
                break
            except sync_api.Error:
                time.sleep(0.2)
        yield opened, link
        browser.close()
    viewer.terminate()
    viewer.wait(20)


def shown(page) -> np.ndarray:
    """What stands right of the panel."""
    from PIL import Image

    image = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    return np.asarray(image).astype(int)[:, PANEL_PX:]


def until(page, is_so, what: str, seconds: float = 90.0) -> np.ndarray:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        page.wait_for_timeout(300)
        pixels = shown(page)
        if is_so(pixels):
            return pixels
    raise AssertionError(f"{what}: not within {seconds} s")


@pytest.mark.slow
def test_a_drag_in_the_browser_changes_the_image(page):
    opened, _ = page
    before = until(opened, lambda p: p.std() > 4.0, "the scene is shown")
    assert opened.title().startswith("view_box")
    assert opened.locator("#status").is_hidden()
    opened.mouse.move(500, 120)
    opened.mouse.down()
    for x in range(505, 600, 10):
        opened.mouse.move(x, 130)
    opened.mouse.up()
    until(opened, lambda p: np.abs(p - before).mean() > 3.0, "the drag is seen")


@pytest.mark.slow
def test_keys_reach_the_image_before_any_click_and_tab_stays_the_viewers(page):
    opened, _ = page
    opened.reload()
    until(opened, lambda p: p.std() > 4.0, "the scene is shown")
    opened.wait_for_function("document.querySelector('.stage .has-focus') !== null")
    opened.keyboard.type("?")
    opened.locator(".help").wait_for(state="visible")
    opened.keyboard.type("?")
    opened.locator(".help").wait_for(state="hidden")
    panel = opened.locator("aside.panel")
    for state in ("visible", "hidden", "visible", "hidden"):
        opened.keyboard.press("Tab")
        panel.wait_for(state=state)
    # After a click at the button the keys are the image's again.
    for state in ("visible", "hidden"):
        opened.locator("button.toggle").click()
        panel.wait_for(state=state)
    opened.keyboard.press("Tab")
    panel.wait_for(state="visible")
    opened.keyboard.press("Tab")
    panel.wait_for(state="hidden")
    assert opened.evaluate("document.querySelector('.stage .has-focus') !== null")


@pytest.mark.slow
def test_keys_fly(page):
    opened, _ = page
    opened.keyboard.press("r")
    opened.wait_for_timeout(2000)
    before = until(opened, lambda p: p.std() > 4.0, "the scene is shown")
    opened.mouse.click(500, 200)
    opened.keyboard.down("d")
    after = until(opened, lambda p: np.abs(p - before).mean() > 3.0, "flying is seen")
    opened.keyboard.up("d")
    assert box_share(after) < 0.9 * box_share(before)  # who flies right sees the box go left


@pytest.mark.slow
def test_the_panel_is_html_beside_the_image_and_a_slider_changes_it(page):
    opened, _ = page
    panel, image = opened.locator("aside.panel"), opened.locator("img.renderview-view")
    assert panel.is_hidden()  # on a narrow page, until it is asked for
    opened.set_viewport_size({"width": 900, "height": 320})
    opened.locator("button.toggle").click()
    panel.wait_for(state="visible")
    until(opened, lambda p: image.bounding_box()["width"] == 900 - 304, "the image makes room")
    before = until(opened, lambda p: p.std() > 4.0, "the scene is shown")
    strength = opened.locator('[data-key^="light.0."] input[type=range]').first
    strength.fill("400")
    until(opened, lambda p: np.abs(p - before).mean() > 3.0, "a weaker light")
    opened.get_by_role("button", name="undo").click()
    until(opened, lambda p: np.abs(p - before).mean() < 1.0, "it is undone")
    opened.locator("button.toggle").click()
    panel.wait_for(state="hidden")


@pytest.mark.slow
def test_two_fingers_come_nearer(page):
    opened, _ = page
    opened.keyboard.press("r")
    opened.wait_for_timeout(2000)
    before = until(opened, lambda p: p.std() > 4.0, "the scene is shown")
    cdp = opened.context.new_cdp_session(opened)

    def touch(kind: str, *places: tuple[int, int]) -> None:
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)]
        cdp.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", (440, 160), (480, 160))
    for step in range(1, 8):
        touch("touchMove", (440 - 4 * step, 160), (480 + 4 * step, 160))
        opened.wait_for_timeout(40)
    touch("touchEnd")
    least = 1.2 * box_share(before)
    after = until(opened, lambda p: box_share(p) > least, "it came nearer")
    assert np.abs(after - before).mean() > 3.0


@pytest.mark.slow
def test_the_image_follows_the_tab(page):
    opened, _ = page
    opened.set_viewport_size({"width": 700, "height": 260})
    image = opened.locator("img.renderview-view")
    until(
        opened,
        lambda p: image.evaluate("i => [i.naturalWidth, i.naturalHeight]") == [700, 260],
        "an image of the new size",
    )
    assert shown(opened).shape == (260, 700 - PANEL_PX, 3)


@pytest.mark.slow
def test_a_second_tab_is_told_that_it_looks_on(page):
    opened, link = page
    second = opened.context.new_page()
    second.goto(link)
    status = second.locator("#status")
    until(second, lambda p: "look on" in status.inner_text(), "the second tab is told")
    assert second.locator("aside.panel").is_hidden()  # what it cannot use it does not show
    second.close()


@pytest.mark.slow
def test_a_wrong_link_says_what_to_do(page):
    opened, link = page
    second = opened.context.new_page()
    answer = second.goto("/".join(link.split("/")[:3]) + "/guess/")
    assert answer.status == 403
    assert "Open the link that `airlight view` printed last" in second.inner_text("body")
    second.close()


@pytest.mark.slow
@pytest.mark.parametrize("width", [900, 500])
def test_in_a_notebook_the_panel_stands_beside_the_image_or_below_it(page, width):
    opened = page[0].context.new_page()
    opened.set_viewport_size({"width": width, "height": 640})
    stage = "<div class=stage style='width:480px; height:200px'></div>"
    opened.set_content(f"<style>{web_text('panel.css')}</style><div id=root>{stage}</div>")
    opened.add_script_tag(content=web_text("panel.js"))
    status = {"type": "status", "shown": True, "title": "", "doubts": [], "share": 0.5, "text": ""}
    opened.evaluate(
        """status => {
          const root = document.getElementById('root')
          new AirlightPanel(root, root.firstChild, () => {}, true).take(status)
        }""",
        {**status, "message": "", "notice": "", "help": None},
    )
    image, panel = (opened.locator(name).bounding_box() for name in (".stage", "aside.panel"))
    if width == 900:
        assert (panel["x"], panel["y"]) == (image["x"] + image["width"], image["y"])
    else:
        assert (panel["x"], panel["y"]) == (image["x"], image["y"] + image["height"])
    opened.close()


@pytest.mark.slow
def test_small_numbers_fit_their_fields_and_notes_are_lines(page):
    opened = page[0].context.new_page()
    opened.set_content(
        f"<style>{web_text('panel.css')}</style><div id=root><div class=stage></div></div>"
    )
    opened.add_script_tag(content=web_text("panel.js"))
    slider = {"key": "a", "kind": "number", "label": "full above", "low": 0.0, "high": 4.96005e-4}
    note = {"key": "b", "kind": "note", "label": "", "value": "right: x\nup: y"}
    widgets = [{**slider, "value": 4.96005e-4, "tip": ""}, {**note, "tip": ""}]
    opened.evaluate(
        """widgets => {
          const root = document.getElementById('root')
          const panel = new AirlightPanel(root, root.firstChild, () => {}, false)
          panel.panel.hidden = false
          panel.showSections([{ name: 'air', open: true, widgets }])
        }""",
        widgets,
    )
    field = opened.locator('[data-key="a"] input[type=number]')
    assert field.input_value() == "4.96e-4"
    assert field.evaluate("f => f.scrollWidth <= f.clientWidth")
    assert opened.locator('[data-key="b"]').inner_text() == "right: x\nup: y"
    opened.close()
