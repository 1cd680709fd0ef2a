"""What both parts of the comparison share: rows of the table, times, and packages that may be missing."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np


class Row(NamedTuple):
    """One line of the table; without seconds, `answer` says why there are none."""

    question: str
    package: str
    seconds: float | None
    answer: str

    def __str__(self) -> str:
        seconds = "-" if self.seconds is None else f"{self.seconds:.6f}"
        return f"| {self.question} | {self.package} | {seconds} | {self.answer} |"


def fastest(work: Callable[[], Any], budget: float = 2.0) -> tuple[float, Any]:
    """Seconds of the fastest of at least three runs, at most about `budget` seconds in all; and the answer."""
    best, answer = np.inf, None
    begin = time.perf_counter()
    for run in range(1000):
        start = time.perf_counter()
        answer = work()
        best = min(best, time.perf_counter() - start)
        if run >= 2 and time.perf_counter() - begin > budget:
            break
    return best, answer


def timed(question: str, package: str, work: Callable[[], Any], tell: Callable[[Any], str] = str) -> Row:
    """The row of some work; what it raises is its answer."""
    try:
        seconds, answer = fastest(work)
    except Exception as error:  # a peer that refuses a mesh is a finding, not the end of the table
        return Row(question, package, None, f"{type(error).__name__}: {str(error).splitlines()[0][:80]}")
    return Row(question, package, seconds, tell(answer))


def module(name: str) -> Any:
    """The package; None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def absent(question: str, package: str) -> Row:
    """The row of a package that is not installed."""
    return Row(question, package, None, "not installed")
