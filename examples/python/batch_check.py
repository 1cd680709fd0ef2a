"""A folder of meshes as a table: a row a file; a file that cannot be read is a row that says so. pandas is optional."""

from pathlib import Path

import selvage


def check(path: Path) -> dict[str, object]:
    """One row. Bad files are answers, too."""
    try:
        mesh = selvage.read_mesh(path)
        pairs = selvage.self_collisions(mesh)
        return {"file": path.name, "vertices": len(mesh.V), "free": len(pairs) == 0, "error": ""}
    except selvage.Error as error:
        return {"file": path.name, "vertices": 0, "free": False, "error": str(error).split(": ", 1)[1]}


# A folder to try it on.
folder = Path("meshes")
folder.mkdir()
selvage.write_mesh(folder / "ball.msh", selvage.make("ball", cell=0.4))
selvage.write_mesh(folder / "rod.msh", selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1))
(folder / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")

rows = [check(path) for path in sorted(folder.iterdir())]
try:
    import pandas

    pandas.DataFrame(rows).to_csv("table.csv", index=False)
except ImportError:
    pass
for row in rows:
    print(f"{row['file']:12} {'free' if row['free'] else 'not free':10}{'unreadable' if row['error'] else ''}".rstrip())

# Prints:
# ball.msh     free
# broken.obj   not free  unreadable
# rod.msh      not free
