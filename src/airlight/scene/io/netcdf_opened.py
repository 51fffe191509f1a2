"""NetCDF files and zarr folders opened by xarray, which reads nothing outside of them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import AirlightError, SceneError
from .files import inside, is_folder, opened, regular_file
from .ledger import note_read

ZARR = ".zarr"
_GET = "Run: pip install 'airlight[science]'."
_MOST_PARTS = 1 << 20


@contextmanager
def opened_dataset(path: Path) -> Iterator[Any]:
    """xarray's dataset of a file, its values still in there. Raises SceneError."""
    engine = _engine(path)
    try:
        import xarray
    except ImportError:
        raise _missing("xarray") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of attributes that are not as the conventions say
            # Times stay numbers: only one is read.
            with xarray.open_dataset(
                path, engine=engine, decode_times=False, cache=False
            ) as dataset:
                if not dataset.variables:
                    raise _nothing(path)
                yield dataset
    except AirlightError:
        raise
    except ImportError as error:
        raise _missing(engine) from error
    except ValueError as error:
        if "unrecognized engine" in str(error):
            raise _missing(engine) from error
        raise _unreadable(error) from error
    except Exception as error:  # each of the libraries has its own
        raise _unreadable(error) from error


def _missing(package: str) -> SceneError:
    return SceneError(f"needs the package {package}, which is not installed", remedy=_GET)


def _unreadable(error: Exception) -> SceneError:
    text = " ".join(str(error).split())[:200]
    return SceneError(f"is not readable ({type(error).__name__}: {text})", remedy="Write it again.")


def _nothing(path: Path) -> SceneError:
    """What is wrong with a file that has no variables: all of them may be in groups."""
    if path.suffix.lower() == ZARR:
        named = sorted(p.parent.name for n in (".zgroup", "zarr.json") for p in path.glob(f"*/{n}"))
    else:
        try:
            import h5py

            with h5py.File(path, "r") as file:
                named = [str(name) for name in file if isinstance(file.get(name), h5py.Group)]
        except Exception:  # NetCDF 3 has no groups
            named = []
    if not named:
        return SceneError("holds no variables", remedy="Write it again.")
    listed = ", ".join(named[:20])
    return SceneError(
        f"holds its variables in groups ({listed}), which are not read",
        remedy=f"Write one into a file of its own: xarray's open_dataset(..., group='{named[0]}') "
        "and to_netcdf.",
    )


def _engine(path: Path) -> str:
    """xarray's name of what reads the file, which names nothing outside of itself."""
    if path.suffix.lower() == ZARR:
        _check_folder(path)
        return "zarr"
    with opened(path) as stream:
        start = stream.read(8)
    if not start:
        raise SceneError("is empty", remedy="Write it again.")
    if start.startswith(b"CDF"):
        return "scipy"
    if start != b"\x89HDF\r\n\x1a\n":
        raise SceneError(
            "is no NetCDF: it begins neither as NetCDF 3 nor as HDF5",
            remedy="xarray's to_netcdf writes one.",
        )
    _check_hdf5(path)
    return "h5netcdf"


def _check_folder(path: Path) -> None:
    """Raise SceneError for what is no folder of regular files, or has links out of it."""
    note_read(path)
    if not is_folder(path):
        regular_file(path)
        raise SceneError("is no zarr folder", remedy="Unpack it: a zarr store is a folder here.")
    count = 0
    # Reading a store opens any of its files, so none of them may lead out of it.
    for folder, folders, files in os.walk(path):
        # Folders that are links are not walked, so that nothing in them would be looked at.
        for name in folders:
            if Path(folder, name).is_symlink():
                raise SceneError(
                    f"holds '{name}', a link to a folder", remedy="Copy what it holds."
                )
        count += len(files)
        if count > _MOST_PARTS:
            raise SceneError(f"has over {_MOST_PARTS:,} files", remedy="Write larger chunks.")
        for name in files:
            part = Path(folder, name)
            if part.is_symlink():
                inside(path, str(part.relative_to(path)), path)
            if not part.is_file():
                raise SceneError(f"holds '{name}', which is no file")


def _check_hdf5(path: Path) -> None:
    """Raise SceneError where links or data of an HDF5 file lie in other files."""
    try:
        import h5py
    except ImportError:
        raise _missing("h5netcdf") from None
    outside = SceneError("has data in other files, which are not followed", remedy="Repack it.")

    # External links and virtual datasets would read files that nobody named.
    def look(group: Any, depth: int) -> None:
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise outside
            # Soft links lead to what the file holds, under its own name.
            if not isinstance(link, h5py.HardLink):
                continue
            found = group[name]
            if isinstance(found, h5py.Dataset) and (found.external or found.is_virtual):
                raise outside
            if isinstance(found, h5py.Group) and depth < 32:
                look(found, depth + 1)

    try:
        with h5py.File(path, "r") as file:
            look(file, 0)
    except AirlightError:
        raise
    except Exception as error:
        raise _unreadable(error) from error
