"""The package: its names, docstrings, types, examples and the command line."""

from __future__ import annotations

import doctest
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import selvage

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples" / "python").glob("*.py"))
PUBLIC = [getattr(selvage, name) for name in selvage.__all__ if name != "__version__"]


def members(thing):
    yield thing.__name__, thing
    if inspect.isclass(thing):
        for name, member in vars(thing).items():
            if not name.startswith("_") and (callable(member) or isinstance(member, property)):
                yield f"{thing.__name__}.{name}", member


ALL = {name: member for thing in PUBLIC for name, member in members(thing)}


def test_all_is_all():
    public = {name for name, value in vars(selvage).items() if not name.startswith("_") and not inspect.ismodule(value)}
    assert public | {"__version__"} == set(selvage.__all__)
    assert selvage.__all__ == sorted(selvage.__all__)


@pytest.mark.parametrize("name", sorted(ALL))
def test_everything_is_documented(name):
    assert (ALL[name].__doc__ or "").strip(), f"{name} has no docstring"


@pytest.mark.parametrize("name", sorted(n for n, m in ALL.items() if inspect.isfunction(m) and "." not in n))
def test_functions_say_what_they_take_and_raise(name):
    document = ALL[name].__doc__
    if "As `" in document or name.startswith("to_"):
        return
    for part in ("Parameters", "Raises", "Examples"):
        assert f"{part}\n    ---" in document, f"{name} has no section {part}"


@pytest.mark.parametrize("name", sorted(ALL))
def test_examples_in_docstrings(name):
    globs = {"np": np, "selvage": selvage}
    test = doctest.DocTestParser().get_doctest(ALL[name].__doc__ or "", globs, name, None, 0)
    runner = doctest.DocTestRunner(verbose=False)
    output: list[str] = []
    runner.run(test, out=output.append)
    assert runner.failures == 0, "".join(output)


def test_types_are_checked(tmp_path):
    """mypy over the package, its stubs and the examples."""
    package = Path(selvage.__file__).parent
    (tmp_path / "selvage").mkdir()
    for file in [*package.glob("*.py"), *package.glob("*.pyi"), package / "py.typed"]:
        (tmp_path / "selvage" / file.name).write_bytes(file.read_bytes())
    arguments = ["--config-file", ROOT / "pyproject.toml", "--cache-dir", tmp_path / "cache", "-p", "selvage"]
    for given in (arguments, [*arguments[:4], *EXAMPLES])[: 2 if EXAMPLES else 1]:
        done = subprocess.run(
            [sys.executable, "-m", "mypy", *map(str, given)],
            cwd=tmp_path, env={"MYPYPATH": str(tmp_path)}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(example, tmp_path):
    if "dask" in example.read_text():
        pytest.importorskip("distributed")
    done = subprocess.run(
        [sys.executable, example],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(Path(selvage.__file__).parents[1])},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = example.read_text().split("# Prints:\n")[1]
    assert done.stdout.splitlines() == [line.removeprefix("# ") for line in told.splitlines()]


def test_the_command_line():
    done = subprocess.run([sys.executable, "-m", "selvage", "--version"], capture_output=True, text=True, check=False)
    assert done.stdout == f"selvage {selvage.__version__}\n"
    bad = subprocess.run(
        [sys.executable, "-m", "selvage", "check", "nothing.obj"], capture_output=True, text=True, check=False
    )
    assert bad.returncode == 2 and "nothing.obj" in bad.stderr


def test_the_version_is_that_of_the_library():
    text = (ROOT / "CMakeLists.txt").read_text()
    assert f"project(selvage VERSION {selvage.__version__} " in text
