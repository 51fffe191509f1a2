"""A USD volume: its density and its fire from OpenVDB files, and a word on its other fields."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ..checks import F64
from ..volume import Volume
from .coefficient_files import colours_of
from .usd_stage import resolved_asset
from .volume_scene import FLAMES, fire, grid_volume
from .volumes import read_values, read_volume

_DENSITIES = ("density", "smoke", "densities")


class UsdVolumes:
    """Reads the volumes of a stage; trouble goes to `warnings`."""

    def __init__(self, stage: Any, folder: Path, time: Any, warnings: list[str]) -> None:
        self._stage, self._folder, self._time = stage, folder, time
        self._warnings = warnings

    def of(self, prim: Any, world: F64) -> Volume | None:
        """A volume placed by `world` (4, 4); None where it has no density.

        Raises SceneError for a grid that cannot be read.
        """
        from pxr import UsdVol

        # Every field that lies in an OpenVDB file; of those one is the density, one the fire.
        paths = UsdVol.Volume(prim).GetFieldPaths()
        fields = {str(name): self._field(prim, str(name), path) for name, path in paths.items()}
        found = {name: field for name, field in fields.items() if field is not None}
        name = next((n for n in _DENSITIES if n in found), None)
        if name is None and len(paths) == 1:
            name = next(iter(found), None)
        if name is None:
            self._warn(prim, "it has no density in an OpenVDB file")
            return None
        file, grid_name = found[name]
        # A fire grows the box of the density, before optics are chosen for it.
        grid, emission, used = read_volume(file, grid_name), None, {name}
        hot = next((n for n in FLAMES if n in found), None)
        if hot is not None:
            try:
                values = read_values(found[hot][0], found[hot][1])
                grid, emission, told = fire(grid, values, hot, file.name, world)
                self._warnings += told
                used.add(hot)
            except SceneError as error:
                self._warn(prim, f"its field '{hot}': {error.problem}")
        volume, told = grid_volume(grid, file, world)
        self._warnings += told
        # The colours of the density's own file are read with it.
        used |= {n for n, field in found.items() if field == (file, colours_of(file))}
        for other in sorted(found.keys() - used):
            self._warn(prim, f"its field '{other}' is left out")
        return replace(volume, emission=emission)

    def _field(self, prim: Any, name: str, path: Any) -> tuple[Path, str] | None:
        """A field's file and the grid in it; None where there is none, which is told."""
        from pxr import UsdVol

        asset = self._stage.GetPrimAtPath(path)
        if not asset or not asset.IsA(UsdVol.OpenVDBAsset):
            self._warn(prim, f"its field '{name}' is in no OpenVDB file")
            return None
        # The path counts from the layer that wrote it.
        vdb = UsdVol.OpenVDBAsset(asset)
        attribute = vdb.GetFilePathAttr()
        value, grid = attribute.Get(self._time), vdb.GetFieldNameAttr().Get(self._time)
        stack = attribute.GetPropertyStack(self._time)
        resolved = resolved_asset(stack[0].layer, str(value.path), self._folder) if value else ""
        if not resolved or not Path(resolved).is_file():
            written = value.path if value else ""
            self._warn(prim, f"the file '{written}' of its field '{name}' is missing")
            return None
        return Path(resolved), str(grid or name)

    def _warn(self, prim: Any, problem: str) -> None:
        self._warnings.append(f"'{prim.GetPath()}': {problem}")
