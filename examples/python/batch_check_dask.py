"""The same as batch_check.py on many machines, with Dask distributed: here a local cluster of two workers.

A worker that dies loses nothing: its files go to another one. A file that cannot be read is a row that says so.
"""

from __future__ import annotations

import os
import signal
from pathlib import Path

import selvage
from dask.distributed import Client, LocalCluster, as_completed


def check(name: str) -> dict[str, object]:
    """One row. Bad files are answers, too."""
    path = Path(name)
    if path.name == "rod.msh" and not Path("died").exists():  # for show: the first worker that gets it dies
        Path("died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    try:
        pairs = selvage.self_collisions(path)
        return {"file": path.name, "free": len(pairs) == 0, "error": ""}
    except selvage.Error as error:
        return {"file": path.name, "free": False, "error": str(error)}


def main() -> None:
    """Makes a folder, and checks it."""
    folder = Path("meshes").absolute()
    folder.mkdir(exist_ok=True)
    selvage.write_mesh(folder / "ball.msh", selvage.make("ball", cell=0.4))
    selvage.write_mesh(folder / "rod.msh", selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1))
    (folder / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,  # or Client("scheduler:8786")
    ):
        work = client.map(check, [str(path) for path in sorted(folder.iterdir())], retries=3)
        rows = [future.result() for future in as_completed(work)]  # as they come
    for row in sorted(rows, key=lambda row: str(row["file"])):
        words = "free" if row["free"] else "not free"
        print(f"{row['file']:12} {words:10}{'unreadable' if row['error'] else ''}".rstrip())


if __name__ == "__main__":
    main()

# Prints:
# ball.msh     free
# broken.obj   not free  unreadable
# rod.msh      not free
