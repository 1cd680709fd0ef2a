"""The exceptions of the package."""


class Error(ValueError):
    """What is wrong with an input, where, and what would mend it, in one line: the same as in C++."""


class SystemError(Error, OSError):  # noqa: A001
    """An Error that is no fault of the input: the system refuses to write, on a full disk, say."""


Error.__module__ = SystemError.__module__ = "selvage"
