"""Does a mesh run into itself, and where? The triangles that do are marked in a file for ParaView or MeshLab."""

import numpy as np
import selvage

mesh = selvage.make("trefoil", cell=0.05, pose="overlap", offset=(0.1, 0, 0)).surface()  # or selvage.read_mesh(...)

pairs = selvage.self_collisions(mesh)
marked = pairs.mark(len(mesh.F))
print(f"{len(pairs) > 0}: {marked.any()} in {'some' if not marked.all() else 'all'} triangles")

# How they meet, and where.
crossing = pairs.contact == selvage.TriangleContact.CROSSING
segments = selvage.SelfCollisionFinder(mesh).find_segments(pairs.triangles[crossing])
length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
print("the curve along which it crosses itself is longer than it is wide:", bool(length > np.ptp(mesh.V, axis=0).min()))

# The marked part alone, as a mesh of its own.
selvage.write_mesh("marked.ply", mesh.V, mesh.F[marked])

# Prints:
# True: True in some triangles
# the curve along which it crosses itself is longer than it is wide: True
