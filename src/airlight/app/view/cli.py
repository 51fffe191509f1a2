"""`airlight view`: fly through a scene, in a window or a browser."""

from __future__ import annotations

from typing import Any

import click

from ...scene.camera import USUAL_PX
from ..options import size_option, solving_options, together
from ..scene_argument import load_scene, show_warnings
from ..scene_options import scene_options

_WHERE = together(
    click.option(
        "--in",
        "place",
        type=click.Choice(["window", "browser"]),
        default="window",
        show_default=True,
        help="Where to look at it.",
    ),
    click.option(
        "--port",
        type=click.IntRange(0, 65535),
        default=0,
        metavar="N",
        help="With --in browser: the port to serve on.  [default: a free one]",
    ),
    click.option(
        "--listen",
        metavar="ADDRESS",
        help="With --in browser: an address other than this machine's own loopback. Anyone who "
        "can reach it and sees the link can look and steer; the link is not encrypted.",
    ),
    click.option(
        "--open/--no-open",
        "opens",
        default=None,
        help="With --in browser: open it, or only say where.  [default: open]",
    ),
)


@click.command("view")
@_WHERE
@solving_options()
@size_option("as many as 1280x720, in the shape of the file's film")
@scene_options()
def command(scene: str, place: str, **options: Any) -> None:
    """Look at SCENE: turn it, fly, move its lights, change its air.

    \b
    airlight view builtin:atrium
    airlight view room.toml --in browser          then open the link that it prints
    ssh -L 8900:localhost:8900 server airlight view room.toml --in browser --port 8900 --no-open

    The scene file is read again whenever it is saved. Drag to turn, w a s d q e to fly,
    control-drag to move the sun, tab for the panel.
    """
    if place == "window" and (options["port"] or options["listen"] or options["opens"] is not None):
        raise click.UsageError("--port, --listen and --open belong to --in browser")
    from .session import Session

    loaded = load_scene(scene, options["model"])
    show_warnings(loaded)
    session = Session(
        loaded,
        source=scene,
        technique=options["technique"],
        settings=options["settings"],
        adapter=options["adapter"],
        model=options["model"],
    )
    size = options["size"] or loaded.camera.size_near(USUAL_PX)
    # A window of its own, or a page that a browser shows.
    if place == "window":
        from .window import open_window

        open_window(session, size)
        return
    from .browser import serve

    serve(
        session,
        size,
        port=options["port"],
        listen=options["listen"] or "",
        opens=options["opens"] is not False,
    )
