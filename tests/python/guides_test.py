"""The commands of the guides to Blender and ParaView run as they stand there, where these programs are installed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from selvage._program import PROGRAM

ROOT = Path(__file__).parents[2]
OTHERS = ("blender", "pvbatch")


def commands(page: str) -> list[str]:
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / "docs" / "guides" / page).read_text(), re.DOTALL)
    return [line for block in blocks for line in block.splitlines()]


def can_run(command: str) -> bool:
    return not command.startswith(OTHERS) or shutil.which(command.split()[0]) is not None


@pytest.mark.parametrize(
    ("page", "results"),
    [
        ("blender.md", ["run.pc2", "run.obj", "run.glb", "run.usda", "marked.ply"]),
        ("paraview.md", ["run/frames.pvd", "run/vtu/frame_000030.vtu", "marked.vtu", "near.vtu", "ways.vtu"]),
    ],
)
def test_commands_of_a_guide(page, results, tmp_path):
    for folder in ("scenes", "examples"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "selvage").symlink_to(PROGRAM)
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"}
    environment.pop("PYTHONPATH", None)
    given = commands(page)
    assert len(given) >= 5
    for command in given:
        if not can_run(command):
            continue
        if command.startswith("pvbatch") and shutil.which("xvfb-run"):
            command = f"xvfb-run -a -s '-screen 0 1280x1024x24' {command}"
        done = subprocess.run(
            ["sh", "-c", command.replace("blender -b", "blender -b --python-exit-code 9")],
            cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        if command.split()[0] in OTHERS or "pvbatch" in command:
            written = tmp_path / command.split()[-1]
            assert written.stat().st_size > 1000, f"{command}\n{done.stdout}{done.stderr}"
    assert all((tmp_path / name).exists() for name in results)
