"""`python -m selvage` and the command `selvage`: the command line program, which the package brings along."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from selvage._errors import SystemError

PROGRAM = Path(__file__).parent / "bin" / "selvage"


def main() -> None:
    """Becomes the program, with the same arguments."""
    try:
        os.execv(PROGRAM, ["selvage", *sys.argv[1:]])
    except OSError as error:
        raise SystemError(f"{PROGRAM}: {error.strerror}; install the package again") from None


if __name__ == "__main__":
    main()
