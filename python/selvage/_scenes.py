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
from selvage._meshes import as_mesh, write_mesh
from selvage._native import KeyframedShape, Scene, SceneSimulation, TetMesh, TriangleMesh, write_point_cache
from selvage._pictures import run_program, small_picture
from selvage._results import Floats, Ints

_SceneLike = Any  # a Scene, the path of a file, or a dict


class _Text(json.JSONEncoder):
    """Scenes may hold NumPy numbers and arrays, paths, meshes and key frames: these two go to files first."""

    def __init__(self, folder: Path, **options: Any) -> None:
        super().__init__(**options)
        self._folder = folder
        self._count = 0

    def default(self, o: Any) -> Any:
        if isinstance(o, (np.ndarray, np.generic)):
            return o.tolist()
        if isinstance(o, os.PathLike):
            return os.fspath(o)
        if isinstance(o, KeyframedShape):
            return self._keyframes(o)
        try:
            mesh = as_mesh(o)
        except Error:
            return super().default(o)
        return {"file": self._write(mesh)}

    def _write(self, mesh: Any) -> str:
        path = self._folder / f"mesh{self._count}.vtu"
        self._count += 1
        write_mesh(path, mesh)
        return str(path)

    def _keyframes(self, shape: KeyframedShape) -> dict[str, Any]:
        mesh = self._write(shape.at(float(shape.times[0])))
        cache = Path(mesh).with_suffix(".pc2")
        write_point_cache(cache, shape.positions)
        return {"mesh": mesh, "pc2": str(cache), "times": shape.times.tolist()}


def read_scene(
    scene: str | os.PathLike[str] | Mapping[str, Any], *, scale: str = "", changes: Mapping[str, Any] | None = None
) -> Scene:
    """Reads a scene file or a dict of the same form, and the meshes that it names.

    Parameters
    ----------
    scene : path or dict
        In a dict, a body's `mesh` may also be a mesh object (see `as_mesh`), a surface for cloth, a collider's
        `keyframed` a `KeyframedShape`, and lists may be arrays. Files that a dict names are relative to the working folder.
    scale : str
        Name of a scale that the scene has; '': as it stands.
    changes : dict, optional
        Values in place of the scene's, after those of the scale, each under its JSON pointer: as `selvage simulate
        --set`.

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
    >>> cloth = selvage.make("cloth", size=(1, 1, 0), cell=0.25)
    >>> scene = {"selvage_scene": 1, "bodies": [{"mesh": cloth, "material": {"kind": "cloth", "density": 0.2}}]}
    >>> selvage.read_scene(scene, changes={"/bodies/0/material/density": 0.3})
    <selvage.Scene 'scene': 1 bodies, 0 elements, 32 triangles of cloth>
    """
    if isinstance(scene, Mapping):
        with tempfile.TemporaryDirectory(prefix="selvage-") as folder:
            try:
                encoder = _Text(Path(folder))
                text = encoder.encode(dict(scene))
                given = [f"{place}={encoder.encode(value)}" for place, value in (changes or {}).items()]
            except TypeError as error:
                raise Error(f"scene: {error}; give numbers, texts, lists, dicts, arrays and meshes") from None
            return _native.scene_of_text(text, Path.cwd() / "scene.json", scale, given)
    given = [f"{place}={json.dumps(value)}" for place, value in (changes or {}).items()]
    return _native.scene_of_file(scene, scale, given)


class Simulation(SceneSimulation):
    """A scene step by step, by the solver that it names, with the contacts of shortest paths.

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
        As `read_scene`, and when a value is impossible. With `guarantee` in the scene also when a step cannot be
        guaranteed.

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
    check_every: int = 0,
    progress: Callable[[dict[str, Any]], object] | None = None,
    on_check: Callable[[int, dict[str, Any]], object] | None = None,
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
    check_every : int
        After so many frames look for what crosses, and write it to checks/; 0: never.
    progress : function, optional
        Called after each frame with its row of statistics.
    on_check : function, optional
        Called after each check with the frame and its crossings: `crosses`, `body_pairs`, `colliders`.

    Returns
    -------
    Run
        Its `report` says how it ended: `outcome`, `message`, `frames` (a row each), `fingerprint`, `at_end` (the
        crossings of the last frame), and `guaranteed_from` (the frame since which nothing has met, or None).

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
        made, folder, frames=frames, resume=resume, vtu=vtu, surface=surface,
        check_every=check_every, progress=progress, on_check=on_check,
    )  # fmt: skip
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
    """(b, 3) int32: the boundary of the tetrahedra, outward, then the triangles of cloth."""

    @property
    def rest(self) -> Floats:
        """(n, 3) float64: positions [m] of the shape at rest."""
        return _native.read_rest_arrays(self.folder)

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
        """The tetrahedra in a frame. A run of cloth alone has none: see `surface`."""
        return TetMesh(self.frame(number), self.T)

    def surface(self, number: int = -1) -> TriangleMesh:
        """All that is seen in a frame: the boundary of the tetrahedra, and cloth."""
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

    def export(self, file: str | os.PathLike[str], *, every: int = 1) -> None:
        """Writes the run for other programs: .pc2 with an .obj beside it, .glb (glTF) or .usda; as `selvage export`.

        Parameters
        ----------
        file : path
            Its extension names the format.
        every : int
            One frame in so many, and the last.

        Raises
        ------
        selvage.Error
            For an unknown extension, and when a file cannot be read or written.
        """
        run_program("export", self.folder, "-o", file, "--every", every)

    def view(self, file: str | os.PathLike[str], *, every: int = 1) -> None:
        """Writes one page for browsers that shows the run; as `selvage view`. Parameters as `export`."""
        run_program("view", self.folder, "-o", file, "--every", every)

    def render(self, file: str | os.PathLike[str], **options: Any) -> None:
        """Draws pictures (.png) or a video (.mp4, .gif); as `selvage render`, whose options are keywords here.

        As in `run.render("last.png", frames="last", colour="speed", size=(480, 360))`; True gives an option without a
        value.
        """
        words: list[object] = []
        for name, value in options.items():
            if value is False or value is None:
                continue
            words.append(f"--{name.replace('_', '-')}")
            if value is not True:
                words += [*value] if isinstance(value, (tuple, list)) else [value]
        run_program("render", self.folder, "-o", file, *words)

    def _repr_png_(self) -> bytes:
        if len(self.T):
            return small_picture(self.mesh())
        with tempfile.TemporaryDirectory(prefix="selvage-") as folder:
            self.render(Path(folder) / "run.png", size=(800, 500))
            return (Path(folder) / "run.png").read_bytes()

    def __repr__(self) -> str:
        return f"<selvage.Run '{self.folder}': {len(self)} frames of {len(self.T)} elements>"


