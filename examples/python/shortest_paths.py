"""How deep is each vertex that is inside the mesh, and which way is out? Drawn by the program's own renderer."""

import numpy as np
import selvage

mesh = selvage.make("rod", cell=0.05, pose="self-crossing", crossings=1)  # or selvage.read_mesh("tangled.msh")

inside = selvage.shortest_paths(mesh)
print("penetrating vertices:", len(np.unique(inside.vertices)) > 0)

# From each vertex a segment to the closest boundary point that a path inside the body leads to.
start, end = inside.queries.points, inside.paths.point
print("the way is as long as its depth:", bool(np.allclose(np.linalg.norm(end - start, axis=1), inside.paths.distance)))
print("and ends on the boundary:", bool((selvage.closest_points(end, mesh).distance < 1e-12).all()))

# In a simulation: the mesh moves a little, and the last answers are a warm start. They never change the new ones.
finder = selvage.BoundaryPathFinder(mesh)
finder.update(mesh.V + 1e-3 * np.sin(mesh.V))
moved = finder.find_penetrating_vertices()
warm = inside.paths.face if len(moved) == len(inside) else None
paths = finder.find_paths(moved.points, moved.elements, sources=moved.sources, warm_start=warm)
print("found after a move:", bool(paths.found.all()))

# A picture, without a display.
selvage.picture(mesh, file="rod.png")

# Prints:
# penetrating vertices: True
# the way is as long as its depth: True
# and ends on the boundary: True
# found after a move: True
