"""A mesh that runs through itself becomes one that does not, and keeps its shape otherwise."""

import numpy as np
import selvage

mesh = selvage.make("rod", cell=0.08, pose="self-crossing", crossings=1)  # or selvage.read_mesh("tangled.msh")
print("before:", "tangled" if selvage.has_self_collisions(mesh) else "free")

free = selvage.resolve(mesh, progress=lambda row: None)  # progress: a dict before each iteration
print("after:", "tangled" if selvage.has_self_collisions(free.V, mesh.T) else "free", f"({free.outcome})")

moved = np.linalg.norm(free.V - mesh.V, axis=1)
print("no vertex moved by more than the rod is long:", bool(moved.max() < np.ptp(mesh.V, axis=0).max()))
print(f"volume changed by less than 2%: {abs(free.report['volume_after'] / free.report['volume_before'] - 1) < 0.02}")
selvage.write_mesh("free.msh", free.V, mesh.T)

# Prints:
# before: tangled
# after: free (resolved)
# no vertex moved by more than the rod is long: True
# volume changed by less than 2%: True
