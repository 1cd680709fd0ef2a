"""Still pictures, drawn by the bundled program without a display."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from selvage._errors import Error, SystemError
from selvage._meshes import as_solid, write_mesh
from selvage._program import PROGRAM


def picture(
    *mesh: Any,
    file: str | os.PathLike[str] | None = None,
    view: Sequence[float] | None = None,
    size: tuple[int, int] = (1600, 1000),
) -> bytes:
    """Draws a mesh of tetrahedra; what has penetrated shines through it, coloured by depth, with its way out.

    In a notebook meshes of tetrahedra and runs draw themselves this way.

    Parameters
    ----------
    mesh : V and T, or a mesh of tetrahedra
        As `shortest_paths`.
    file : path, optional
        .png to write.
    view : three numbers, optional
        Direction from the mesh to the eye; else a good one is chosen.
    size : (int, int)
        [pixels]

    Returns
    -------
    bytes
        The PNG.

    Raises
    ------
    selvage.Error
        When the mesh is a surface, or a number is impossible.
    selvage.SystemError
        When the file cannot be written.

    Examples
    --------
    >>> png = selvage.picture(selvage.make("ball", cell=0.4), size=(200, 100))
    >>> png[1:4]
    b'PNG'
    """
    solid = as_solid(*mesh)
    with tempfile.TemporaryDirectory(prefix="selvage-") as name:
        folder = Path(name)
        write_mesh(folder / "mesh.vtu", solid)
        words: list[object] = ["paths", "mesh.vtu", "--picture", "picture.png", "--picture-size", *size]
        if view is not None:
            words += ["--view", *view]
        run_program(*words, folder=folder)
        png = (folder / "picture.png").read_bytes()
    if file is not None:
        try:
            Path(file).write_bytes(png)
        except OSError as error:
            raise SystemError(f"{os.fspath(file)}: {error.strerror}") from None
    return png


def run_program(*words: object, folder: Path | None = None) -> None:
    """Runs the bundled program quietly; its error is raised."""
    arguments = [PROGRAM, *(os.fspath(w) if isinstance(w, os.PathLike) else str(w) for w in words), "--quiet"]
    done = subprocess.run(arguments, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Error(done.stderr.removeprefix("selvage: ").strip() or f"{words[0]}: failed")


def small_picture(mesh: Any) -> bytes:
    """For notebooks."""
    return picture(mesh, size=(800, 500))
