"""The `airlight` command: finds its commands, and turns errors into messages and exit codes.

Exit 0: done. 2: bad input or a missing capability, in one message. 1: a mistake of ours.
130: interrupted. 141: whoever read the output has closed its pipe.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import re
import shlex
import sys
import traceback
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn, cast

import click

from .. import __version__, env, interrupts
from ..errors import AirlightError, SettingsError, SettingsWarning, memory_wanted, nearest, one_line
from .streams import ClosedPipe, guarded, let_go, say

COMMANDS: tuple[str, ...] = (
    "render",
    "view",
    "sequence",
    "turntable",
    "compare",
    "info",
    "validate",
    "convert",
    "export-lattice",
    "scenes",
    "figure",
    "bench",
    "doctor",
)
"""Commands in the order of the help page; `airlight.app.NAME` makes one, if it is there."""


PIPE_CLOSED = 141  # as shells say of programs that SIGPIPE ends


class _Commands(click.Group):
    """Imports a command only when it is asked for, so that `--help` needs no graphics."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for name in COMMANDS if importlib.util.find_spec(_module(name))]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        return cast(click.Command, importlib.import_module(_module(cmd_name)).command)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Of a word that is no command, what was meant: another command, or to render a file."""
        name = args[0]
        if not name.startswith("-") and name not in self.list_commands(ctx):
            is_scene = "." in name or name.startswith("builtin:")
            meant = f"To draw it: airlight render {shlex.quote(name)} -o image.png"
            remedy = meant if is_scene else nearest(name, self.list_commands(ctx))
            ctx.fail(f"No such command '{one_line(name)}'. {remedy}")
        return super().resolve_command(ctx, args)


def _module(command: str) -> str:
    return f"{__package__}.{command.replace('-', '_')}"


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="airlight")
def airlight() -> None:
    """Light transport in air: a scene file in, a lit image out, with a GPU or without.

    A SCENE is a scene file (.toml, .xml), a mesh (.gltf, .glb, .obj, .ply, .stl, .usd), a density
    grid (.vdb, .nvdb, .npy, .npz, .vol, .vti, .nc, .zarr), a folder or a pattern of grids
    ('smoke_*.vdb'), which is a sequence, or builtin:NAME; `airlight scenes` lists the names.
    """


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    interrupts.leave_quietly()
    code = run(arguments)
    # Full or closed streams must not make Python complain while it ends.
    let_go()
    sys.exit(code)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    from ..scene.io.ledger import recorded

    try:
        # Files that the command reads are recorded, so that it does not write over them.
        with interrupts.taken_up(), guarded(), recorded(), _warnings_said():
            code = airlight.main(args=arguments, prog_name="airlight", standalone_mode=False)
        return code if isinstance(code, int) else 0
    # What a person can mend is one line and exit code 2.
    except AirlightError as error:
        if error.__cause__ is not None and env.is_on("AIRLIGHT_DEBUG"):
            traceback.print_exception(error)
        say(f"error: {error}")
        _hint_at_parameters(sys.argv[1:] if arguments is None else arguments, error)
        return 2
    except click.ClickException as error:
        with contextlib.suppress(OSError):
            error.show()
        _hint_at_quotes(error)
        return error.exit_code
    # What came from outside is no error of ours.
    except (KeyboardInterrupt, click.Abort):
        say("interrupted")
        return interrupts.INTERRUPTED
    except ClosedPipe:
        return PIPE_CLOSED
    except MemoryError as error:
        say(
            f"error: there is not enough memory{memory_wanted(error)}. Use a smaller scene, image "
            "or lattice, or free some memory."
        )
        return 2
    except Exception as error:
        return _report(error)


@contextlib.contextmanager
def _warnings_said() -> Iterator[None]:
    """What Python gets as a warning of ours is a line on stderr, each once."""
    with warnings.catch_warnings():
        shown = warnings.showwarning

        def say_ours(message: Any, category: Any, *where: Any, **more: Any) -> None:
            if issubclass(category, SettingsWarning):
                say(f"warning: {message}")
            else:
                shown(message, category, *where, **more)

        warnings.simplefilter("once", SettingsWarning)
        warnings.showwarning = say_ours
        yield


def _hint_at_quotes(error: click.ClickException) -> None:
    """Where a shell has made many files of a pattern, say how to keep it from that."""
    if error.message.startswith("Got unexpected extra argument"):
        say("A pattern of files stands in quotes: 'smoke_*.vdb'.")


def _hint_at_parameters(arguments: Sequence[str], error: AirlightError) -> None:
    """Where -D names a parameter of a Mitsuba file, as Mitsuba's does, say which option does."""
    found = re.search(r"setting '(\w+)'", error.problem)
    files = [text for text in arguments if text.lower().endswith(".xml")]
    if not (found and files and isinstance(error, SettingsError)):
        return
    name = found[1]
    with contextlib.suppress(OSError, AirlightError):
        from ..scene.io.files import read_bytes

        if f"${name}".encode() in read_bytes(Path(files[0])):
            say(f"${name} is a parameter of {files[0]}: --param {name}=VALUE sets it.")


def _report(error: Exception) -> int:
    """Say that the mistake is ours, in one line."""
    # A traceback is for whoever mends it, the line for whoever meets it.
    if env.is_on("AIRLIGHT_DEBUG"):
        traceback.print_exception(error)
    what = " ".join(str(error).split()) or "no message"
    say(
        f"internal error: {type(error).__name__}: {what}. Please report it, with the output of "
        "`airlight doctor` and of the same command under AIRLIGHT_DEBUG=1."
    )
    return 1
