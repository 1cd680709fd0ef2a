"""A loop written with ipctk, and what stands in its place: the same arrays in the same order.

| ipctk | selvage |
| --- | --- |
| `ipctk.edges(F)`, `ipctk.CollisionMesh(rest, E, F)` | `selvage.TriangleMesh(rest, F)` |
| `ipctk.has_intersections(mesh, V)` | `selvage.has_self_collisions(V, F)` |
| `ipctk.is_step_collision_free(mesh, V0, V1)` | `not selvage.ContinuousCollisionFinder(mesh, V0, V1).has_pairs()` |
| `ipctk.compute_collision_free_stepsize(mesh, V0, V1)` | `selvage.free_step(V0, V1, F)` |
| `candidates.build(mesh, V, dhat)` | `selvage.near_pairs(V, F, distance=dhat)` |
"""

import numpy as np
import selvage

cloth = selvage.make("cloth", cell=0.1)
F = cloth.F
V = np.vstack([cloth.V, cloth.V + [0.03, 0.02, 0.05]])
F = np.vstack([F, F + len(cloth.V)])  # two sheets, the upper one a little aside
dhat, weight = 0.02, 1e-4

mesh = selvage.TriangleMesh(V, F)
finder = selvage.ContinuousCollisionFinder(mesh, V, V)
near = selvage.ProximityFinder(mesh, distance=dhat)
shortest = 1.0
for _ in range(12):
    # Gravity on the upper sheet, and a barrier b(d) = -(d - dhat)^2 log(d / dhat) between what is near.
    step = np.zeros_like(V)
    step[len(cloth.V) :, 2] -= 0.01
    near.update(V)
    pairs = near.find_pairs()
    d = pairs.vertex_face_distance
    slope = -(d - dhat) * (2 * np.log(d / dhat) + (d - dhat) / d)
    normal = (pairs.vertex_face_nearest[:, 0] - pairs.vertex_face_nearest[:, 1]) / d[:, None]
    np.add.at(step, pairs.vertex_face[:, 0], np.clip(-weight * slope / dhat**2, 0, 0.1 * d)[:, None] * normal)

    finder.update(V, V + step)  # was: ipctk.compute_collision_free_stepsize(mesh, V, V + step)
    alpha = finder.find_free_step()
    shortest = min(shortest, alpha)
    V = V + 0.9 * alpha * step

print("some step had to be shortened:", shortest < 1)
print("free at the end:", not selvage.has_self_collisions(V, F))

# Prints:
# some step had to be shortened: True
# free at the end: True
