"""Scenes, simulations and the folders of runs."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from selvage import _native
from selvage._errors import Error
from selvage._meshes import as_solid, write_mesh
from selvage._native import Scene, SceneSimulation, TetMesh, TriangleMesh
from selvage._pictures import small_picture
from selvage._results import Floats, Ints

_SceneLike = Any  # a Scene, the path of a file, or a dict


class _Text(json.JSONEncoder):
    """Scenes may hold NumPy numbers and arrays, paths, and meshes: these go to a file first."""

    def __init__(self, folder: Path, **options: Any) -> None:
        super().__init__(**options)
        self._folder = folder
        self._count = 0

    def default(self, o: Any) -> Any:
        if isinstance(o, (np.ndarray, np.generic)):
            return o.tolist()
        if isinstance(o, os.PathLike):
            return os.fspath(o)
        try:
            mesh = as_solid(o)
        except Error:
            return super().default(o)
        path = self._folder / f"mesh{self._count}.vtu"
        self._count += 1
        write_mesh(path, mesh)
        return {"file": str(path)}


def read_scene(scene: str | os.PathLike[str] | Mapping[str, Any], *, scale: str = "") -> Scene:
    """Reads a scene file or a dict of the same form, and the meshes that it names.

    Parameters
    ----------
    scene : path or dict
        In a dict, a body's `mesh` may also be a mesh object (see `as_mesh`), and lists may be arrays. Files that a
        dict names are relative to the working folder.
    scale : str
        Name of a scale that the scene has; '': as it stands.

    Returns
    -------
    Scene

    Raises
    ------
    selvage.Error
        File, path within (as in bodies[2].material.poisson_ratio), what is wrong, what is allowed.

    Examples
    --------
    >>> box = selvage.make("box", size=(0.2, 0.2, 0.2), cell=0.1)
    >>> selvage.read_scene({"selvage_scene": 1, "bodies": [{"mesh": box, "translate": [0, 0, 1]}]})
    <selvage.Scene 'scene': 1 bodies, 48 elements>
    """
    if isinstance(scene, Mapping):
        with tempfile.TemporaryDirectory(prefix="selvage-") as folder:
            try:
                text = _Text(Path(folder)).encode(dict(scene))
            except TypeError as error:
                raise Error(f"scene: {error}; give numbers, texts, lists, dicts, arrays and meshes") from None
            return _native.scene_of_text(text, Path.cwd() / "scene.json", scale)
    return _native.scene_of_file(scene, scale)


class Simulation(SceneSimulation):
    """A scene step by step: XPBD with the contacts of shortest paths. Scenes for other solvers run by `simulate`.

    Parameters
    ----------
    scene : Scene, path or dict
        See `read_scene`.
    scale : str
        Name of a scale that the scene has.

    Attributes
    ----------
    positions, velocities : (n, 3) float64
        [m] and [m/s]. Each step writes into these very arrays; write to them between steps.
    time, steps, frame
        Where the simulation is.

    Raises
    ------
    selvage.Error
        As `read_scene`, when a value is impossible, and when the scene is for a solver other than XPBD.

    Notes
    -----
    A scene run this way and one run by `simulate` end in the same bits.

    Examples
    --------
    >>> box = selvage.make("box", size=(0.2, 0.2, 0.2), cell=0.1)
    >>> falling = selvage.Simulation({"selvage_scene": 1, "bodies": [{"mesh": box}]})
    >>> falling.step(300)
    >>> falling.time, float(falling.positions[:, 2].max().round(2)), float(falling.velocities[0, 2].round(2))
    (1.0, -4.72, -9.81)
    """

    def __init__(self, scene: _SceneLike, *, scale: str = "") -> None:
        super().__init__(scene if isinstance(scene, Scene) else read_scene(scene, scale=scale))

    def __repr__(self) -> str:
        return f"<selvage.Simulation of {self.scene!r} at {self.time:.4g} s>"


def simulate(
    scene: _SceneLike,
    folder: str | os.PathLike[str],
    *,
    frames: int | None = None,
    resume: bool = False,
    scale: str = "",
    vtu: bool = False,
    surface: str | None = None,
    progress: Callable[[dict[str, Any]], object] | None = None,
) -> Run:
    """Runs a scene and writes its frames, statistics and checkpoints to a folder; as `selvage simulate`.

    Parameters
    ----------
    scene : Scene, path or dict
        See `read_scene`.
    folder : path
        Made if it is not there.
    frames : int, optional
        Instead of the scene's.
    resume : bool
        Continue the run that the folder holds; without one, begin.
    scale : str
        Name of a scale that the scene has.
    vtu : bool
        Also files for ParaView.
    surface : str, optional
        'ply' or 'obj': also the surface of each frame.
    progress : function, optional
        Called after each frame with its row of statistics.

    Returns
    -------
    Run
        Its `report` says how it ended.

    Raises
    ------
    selvage.Error
        When the folder holds another run, or a file in it is damaged.
    selvage.SystemError
        When a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> box = selvage.make("box", size=(0.2, 0.2, 0.2), cell=0.1)
    >>> run = selvage.simulate({"selvage_scene": 1, "bodies": [{"mesh": box}]}, tempfile.mkdtemp(), frames=2)
    >>> run.report["outcome"], len(run), run.frame(2).shape
    ('finished', 3, (27, 3))
    """
    made = scene if isinstance(scene, Scene) else read_scene(scene, scale=scale)
    report = _native.run_scene_to(
        made, folder, frames=frames, resume=resume, vtu=vtu, surface=surface, progress=progress
    )
    return Run(folder, report=report)


class Run:
    """The folder of a run, as arrays.

    Parameters
    ----------
    folder : path
        That `simulate` or the command line wrote.

    Raises
    ------
    selvage.Error
        When there is no run, or a file in it is damaged.

    Examples
    --------
    >>> import tempfile
    >>> folder = tempfile.mkdtemp()
    >>> scene = {"selvage_scene": 1, "bodies": [{"mesh": {"shape": "box", "cell": 0.5}}]}
    >>> _ = selvage.simulate(scene, folder, frames=3)
    >>> run = selvage.Run(folder)
    >>> bool(run.frame(0)[:, 2].mean() > run.frame(3)[:, 2].mean())
    True
    >>> run.statistics["time"].round(3)
    array([0.   , 0.017, 0.033, 0.05 ])
    """

    def __init__(self, folder: str | os.PathLike[str], *, report: dict[str, Any] | None = None) -> None:
        self.folder = Path(folder)
        self.report = report
        """How the run ended, where `simulate` made it."""
        self.T, self.vertex_bodies, self.boundary_faces = _native.read_topology_arrays(self.folder)

    T: Ints
    """(m, 4) int32: tetrahedra."""
    vertex_bodies: Ints
    """(n,) int32: the body of each vertex."""
    boundary_faces: Ints
    """(b, 3) int32: the boundary, outward."""

    def __len__(self) -> int:
        """Number of frames that are there, the one at the start included."""
        count = 0
        while _native.frame_file(self.folder, count).exists():
            count += 1
        return count

    def frame(self, number: int) -> Floats:
        """(n, 3) float64: positions [m] in a frame; -1 is the last. Frames are stored in single precision.

        Raises
        ------
        selvage.Error
            When there is no such frame.
        """
        wanted = len(self) + number if number < 0 else number
        return _native.read_frame_arrays(self.folder, wanted)[0]

    def __getitem__(self, number: int) -> Floats:
        """As `frame`."""
        if not -len(self) <= number < len(self):
            raise IndexError(f"frame {number}: the run has {len(self)}")
        return self.frame(number)

    def __iter__(self) -> Iterator[Floats]:
        """Positions of the frames, one after the other."""
        return (self.frame(number) for number in range(len(self)))

    def mesh(self, number: int = -1) -> TetMesh:
        """The mesh in a frame."""
        return TetMesh(self.frame(number), self.T)

    def surface(self, number: int = -1) -> TriangleMesh:
        """The boundary in a frame."""
        return TriangleMesh(self.frame(number), self.boundary_faces)

    def checkpoint(self) -> tuple[Floats, Floats, float]:
        """Positions [m], velocities [m/s] and time [s] after the last whole frame, in double precision."""
        return _native.read_checkpoint_arrays(self.folder)[:3]

    @property
    def statistics(self) -> dict[str, Floats]:
        """Columns of statistics.csv, one value per frame; `pandas.DataFrame(run.statistics)` makes a table."""
        with (self.folder / "statistics.csv").open(newline="") as file:
            rows = [row for row in csv.DictReader(file)]
        return {name: np.array([float(row[name]) for row in rows]) for name in (rows[0] if rows else ())}

    @property
    def summary(self) -> dict[str, Any]:
        """The contents of summary.json: counts, averages per step, shares of time."""
        values: dict[str, Any] = json.loads((self.folder / "summary.json").read_text())
        return values

    def _repr_png_(self) -> bytes:
        return small_picture(self.mesh())

    def __repr__(self) -> str:
        return f"<selvage.Run '{self.folder}': {len(self)} frames of {len(self.T)} elements>"


