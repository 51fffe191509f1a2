"""The viewer: `cli` opens it, `session` draws frames onto any texture, canvases show them.

state, controls, quality, panel   what is shown, and what hands ask for; they know no toolkit
drawn, build, making, fine        a renderer and its scene; others made behind it, in a thread
session                           a frame from all of these
canvas, window, browser, notebook where it is seen; guard, messages: who may say what
gui, gui_scene, save, watch       the panel drawn, scene files written and read again
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
