"""A sheet over a figure that an animation moves: a surface by key frames is a collider, and the run is guaranteed."""

import numpy as np
import selvage

rod = selvage.make("rod", length=0.9, radius=0.1, cell=0.06)  # along x; or any closed surface of yours
F, height = rod.boundary_faces, rod.V[:, :1]
body = rod.V[:, 1:] * (0.7 + 0.5 * np.exp(-(((height - 0.78) / 0.12) ** 2)))  # across: it has a neck and a head


def pose(bow: float) -> np.ndarray:
    """The figure upright, or bent forwards so that its head is turned by `bow` [rad]."""
    angle = bow * height / 0.9
    spine = 0.9 / bow * np.hstack([1 - np.cos(angle), np.sin(angle)]) if bow else np.hstack([0 * height, height])
    across = body[:, :1] * np.hstack([np.cos(angle), -np.sin(angle)])
    return np.column_stack([(spine + across)[:, 0], body[:, 1], (spine + across)[:, 1]])


times = np.linspace(0, 2, 41)  # [s]; selvage.read_point_cache("dancer.pc2") gives what Blender has stored
bows = 0.5 * np.sin(np.pi * np.maximum(times - 0.5, 0))
figure = selvage.KeyframedShape(F, times, np.array([pose(bow) for bow in bows]))
sheet = {
    "name": "sheet",
    "mesh": {"shape": "cloth", "size": [1.4, 1.4, 0], "cell": 0.07},
    "translate": [-0.7, -0.7, 0.93],
    "material": {"kind": "cloth", "thickness": 0.005},
}
scene = {
    "selvage_scene": 1,
    "frames": 120,
    "contact": {"guarantee": True},
    "bodies": [sheet],
    "colliders": [
        {"keyframed": figure, "static_friction": 0.6, "dynamic_friction": 0.5},
        {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
    ],
}

run = selvage.simulate(scene, "figure")
x = run.frame(-1)
print("frames:", len(run))
print("the sheet hangs on the figure:", bool(x[:, 2].max() > 0.7 and x[:, 2].min() < 0.5))
print("nothing meets:", not selvage.has_self_collisions(selvage.TriangleMesh(x, run.boundary_faces)))

# Prints:
# frames: 121
# the sheet hangs on the figure: True
# nothing meets: True
