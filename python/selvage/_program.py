"""Where the command line program is."""

from pathlib import Path

PROGRAM = Path(__file__).parent / "bin" / "selvage"
