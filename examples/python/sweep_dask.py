"""One scene with many values of a parameter, over Dask distributed. Run it again and it goes on where it stopped: every
run has its folder, and `resume` continues it from its last whole frame."""

from __future__ import annotations

from pathlib import Path

import selvage
from dask.distributed import Client, LocalCluster


def run(stiffness: float, folder: str) -> tuple[float, float]:
    """Young's modulus [Pa]; how much lower the middle of the box is in the end [m]."""
    scene = {
        "selvage_scene": 1,
        "frames": 20,
        "bodies": [
            {
                "mesh": {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1},
                "material": {"youngs_modulus": stiffness},
            }
        ],
        "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
    }
    with selvage.threads(1):
        done = selvage.simulate(scene, Path(folder) / f"{stiffness:.0f}", resume=True)
    return stiffness, float((done.frame(0) - done.frame(-1))[:, 2].mean())


def main() -> None:
    """A small sweep."""
    folder = str(Path("sweep").absolute())
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        results = client.gather(client.map(run, [2e3, 1e4, 1e5], folder=folder, retries=3))
    sags = [sag for _, sag in results]
    print("folders:", sorted(path.name for path in Path(folder).iterdir()))
    print("softer boxes sag more:", sags == sorted(sags, reverse=True) and sags[-1] > 0)


if __name__ == "__main__":
    main()

# Prints:
# folders: ['10000', '100000', '2000']
# softer boxes sag more: True
