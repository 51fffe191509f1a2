"""The viewer: a session draws frames onto any texture, canvases show them.

    input -> document -> session -> a frame -> canvas -> window, browser or notebook

document, source, history          the scene that is open, where it came from, what can be undone
state, controls, quality, panel    what is shown and what input asks for; no toolkit
gizmos, projection, free_space     lights in the image; points and pixels; where the eye may go
drawn, build, making, fine, finer  a renderer and its scene; others created in the background
renderers                          which of them there are, and which are wanted
second_view                        one that shows what another one has solved
session                            a frame from all of these; shown: on which texture
canvas, window, browser, notebook  where it is shown; guard, messages, uploads: who may send what
widgets, sections, scene_sections  the panel, declared; air_section: its media and grids, with
                                   slices through those
gui, gui_*, page, help             drawn by imgui, or in a page; asking: the dialog for a file
save, watch                        scene files written and read again; cli: the command
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
