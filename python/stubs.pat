selvage._native.__prefix__:
    import os
    import pathlib
    from collections.abc import Callable
    from typing import Any

    from numpy.typing import ArrayLike

    from selvage._results import (
        ClosestPoints, Codes, Contacts, ContinuousPairs, Floats, Ints, LocatedPoints, NearPairs, PathQueries, Paths,
        SignedDistances, TrianglePairs,
    )
