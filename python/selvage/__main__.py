"""`python -m selvage` and the command `selvage`: the command line program, which the package brings along."""

from __future__ import annotations

import os
import sys

from selvage._errors import SystemError
from selvage._program import PROGRAM


def main() -> None:
    """Becomes the program, with the same arguments."""
    try:
        os.execv(PROGRAM, ["selvage", *sys.argv[1:]])
    except OSError as error:
        raise SystemError(f"{PROGRAM}: {error.strerror}; install the package again") from None


if __name__ == "__main__":
    main()
