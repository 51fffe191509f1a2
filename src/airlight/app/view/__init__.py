"""The viewer: a session draws frames onto any texture, canvases show them.

state, controls, quality, panel    what is shown and what input asks for; no toolkit
drawn, build, making, fine         a renderer and its scene; others created in the background
session                            a frame from all of these
canvas, window, browser, notebook  where it is shown; guard, messages: who may send what
gui, gui_scene, save, watch        the panel; scene files written and read again
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
