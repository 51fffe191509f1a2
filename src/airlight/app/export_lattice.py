"""`airlight export-lattice`: the solved light field, for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..errors import OutputError
from .options import output_option, solving_options
from .outputs import check_folder, check_writable
from .scene_argument import load_scene, reads, show_warnings
from .scene_options import scene_options


@click.command("export-lattice")
@output_option("FILE.npz|FILE.vdb|DIR", "A folder is for .npy files and header.json.")
@solving_options("lpv, lpv-march, lpv-sum, lpv-scatter, pop or auto.")
@scene_options()
def command(scene: str, output: Path, **options: Any) -> None:
    """Solve the light in SCENE and write it as NumPy arrays with a JSON header.

    \b
    airlight export-lattice builtin:room -o room-light.npz -t lpv
    airlight export-lattice fog.toml -o light/ -D resolution=48
    airlight export-lattice fog.toml -o light.vdb

    The header gives placement, units, basis and order. Lattices hold radiance in spherical
    harmonics of order 1 and irradiance on six sides of every cell; volumes solved by pop hold
    what they scatter towards the scene's camera. A .vdb holds grids of colours: the mean radiance
    in each lattice, what air scatters, and what volumes scatter.
    """
    # Refuse before solving what could not be written after it.
    reads(scene)
    _check_output(output)
    from ..exports.solved import export_lattice

    loaded = load_scene(scene, options["model"])
    # Checked again: the scene may have read what would be written.
    _check_output(output)
    export_lattice(
        loaded,
        output,
        technique=options["technique"],
        settings=options["settings"],
        adapter=options["adapter"],
    )
    show_warnings(loaded)
    click.echo(str(output))


def _check_output(output: Path) -> None:
    """Refuse, before any work, what could not be written after it. Raises OutputError."""
    if output.suffix in (".npz", ".vdb"):
        check_writable(output)
    elif output.suffix:
        raise OutputError(
            f"cannot write a light field that ends in '{output.suffix}'",
            where=output,
            remedy="End its name in .npz or .vdb, or name a folder.",
        )
    else:
        check_folder(output)
