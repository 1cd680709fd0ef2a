"""Exact, fast self-collision of deformable meshes.

`V` are positions (n, 3) in metres, `F` triangles (m, 3), `T` tetrahedra (m, 4), all NumPy arrays or what can be made
one. Every function that takes `V, F` or `V, T` also takes a mesh: of this package, of trimesh, meshio or PyVista, or
the path of a file::

    import selvage

    mesh = selvage.read_mesh("tangled.msh")
    pairs = selvage.self_collisions(mesh)  # triangles that meet
    inside = selvage.shortest_paths(mesh)  # penetrating vertices, and their ways out
    free = selvage.resolve(mesh)  # the mesh without self-collision

Work runs in parallel without the interpreter's lock, gives the same bits for any number of threads, and stops on
Ctrl-C. What cannot be raises `selvage.Error`, in one line that says what would mend it.
"""

from selvage import _native
from selvage._errors import Error, SystemError
from selvage._functions import (
    PenetratingPaths,
    closest_points,
    collisions_between,
    continuous_collisions,
    free_step,
    has_self_collisions,
    near_pairs,
    self_collisions,
    shortest_paths,
    signed_distance,
)
from selvage._geometry import impact_times, triangle_contacts
from selvage._marked_files import write_coloured_ply, write_vtu
from selvage._meshes import (
    as_mesh,
    boundary_faces,
    join,
    make,
    pose,
    read_groups,
    read_mesh,
    to_meshio,
    to_pyvista,
    to_trimesh,
    write_mesh,
)
from selvage._native import (
    BoundaryPathFinder,
    ContactFinder,
    ContinuousCollisionFinder,
    KeyframedShape,
    PairFilters,
    PlanarMesh,
    PlanarPathFinder,
    ProximityFinder,
    Scene,
    SelfCollisionFinder,
    SurfaceDistance,
    SurfaceSequence,
    TetMesh,
    TriangleMesh,
    culling_methods,
    holds_tetrahedra,
    orient2d,
    orient3d,
    pose_names,
    read_point_cache,
    sequence_names,
    shape_names,
    threads,
    write_point_cache,
)
from selvage._pictures import picture
from selvage._pictures import small_picture as _small_picture
from selvage._results import (
    ClosestPoints,
    ContactKind,
    Contacts,
    ContinuousPairs,
    Feature,
    LocatedPoints,
    NearPairs,
    PathQueries,
    Paths,
    PathStatus,
    SignedDistances,
    TriangleContact,
    TrianglePairs,
)
from selvage._scenes import Run, Simulation, read_scene, simulate
from selvage._untangling import Resolved, resolve

__version__ = _native.version

__all__ = [
    "BoundaryPathFinder",
    "ClosestPoints",
    "ContactFinder",
    "ContactKind",
    "Contacts",
    "ContinuousCollisionFinder",
    "ContinuousPairs",
    "Error",
    "Feature",
    "KeyframedShape",
    "LocatedPoints",
    "NearPairs",
    "PairFilters",
    "PathQueries",
    "PathStatus",
    "Paths",
    "PenetratingPaths",
    "PlanarMesh",
    "PlanarPathFinder",
    "ProximityFinder",
    "Resolved",
    "Run",
    "Scene",
    "SelfCollisionFinder",
    "SignedDistances",
    "Simulation",
    "SurfaceDistance",
    "SurfaceSequence",
    "SystemError",
    "TetMesh",
    "TriangleContact",
    "TriangleMesh",
    "TrianglePairs",
    "__version__",
    "as_mesh",
    "boundary_faces",
    "closest_points",
    "collisions_between",
    "continuous_collisions",
    "culling_methods",
    "free_step",
    "has_self_collisions",
    "holds_tetrahedra",
    "impact_times",
    "join",
    "make",
    "near_pairs",
    "orient2d",
    "orient3d",
    "picture",
    "pose",
    "pose_names",
    "read_groups",
    "read_mesh",
    "read_point_cache",
    "read_scene",
    "resolve",
    "self_collisions",
    "sequence_names",
    "shape_names",
    "shortest_paths",
    "signed_distance",
    "simulate",
    "threads",
    "to_meshio",
    "to_pyvista",
    "to_trimesh",
    "triangle_contacts",
    "write_coloured_ply",
    "write_mesh",
    "write_point_cache",
    "write_vtu",
]

# In a notebook.
setattr(TetMesh, "_repr_png_", _small_picture)
