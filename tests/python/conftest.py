"""Meshes that the tests ask about, and the command line program, which is the C++ that answers must equal."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
import selvage
from selvage._program import PROGRAM

Program = Callable[..., Any]


@pytest.fixture(scope="session")
def rod() -> selvage.TetMesh:
    """A rod that runs through itself."""
    return selvage.make("rod", cell=0.06, pose="self-crossing", crossings=1)


@pytest.fixture(scope="session")
def pipe() -> selvage.SurfaceSequence:
    """A surface in motion that runs into itself."""
    return selvage.SurfaceSequence("pipe", triangles=4000)


@pytest.fixture
def two() -> tuple[np.ndarray, np.ndarray]:
    """Two triangles that cross."""
    V = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [2, 1, 2.0]])
    return V, np.array([[0, 1, 2], [3, 4, 5]], np.int32)


@pytest.fixture
def program(tmp_path: Path) -> Program:
    """Runs the program; returns what it wrote as JSON."""

    def run(command: str, *arguments: object, allowed: tuple[int, ...] = (0,)) -> Any:
        output = tmp_path / "answer.json"
        words = [PROGRAM, command, *map(str, arguments), "--quiet", "--json", output]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.returncode in allowed, done.stderr
        return json.loads(output.read_text())

    return run
