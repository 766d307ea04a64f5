# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong: one exception for each code of the engine's errors, each also one of Python's own."""

from __future__ import annotations

import errno


class Error(Exception):
    """An error of the engine: one sentence that says what is wrong, what was expected and what to do.

    Attributes:
        code: The kind of error, as in the program's JSON: ``"invalid_argument"``.
        message: The sentence.
        context: The file, page, line or argument that it is about; may be empty.
    """

    code: str = "internal"
    message: str = ""
    context: str = ""

    def __str__(self) -> str:  # OSError would say it otherwise where it has a file name
        return str(self.args[0]) if self.args else self.message


class InvalidArgument(Error, ValueError):
    """A value or an input is not what was asked for."""

    code = "invalid_argument"


class NotFound(Error, FileNotFoundError):
    """The file or object does not exist."""

    code = "not_found"


class Corruption(Error, OSError):
    """What is stored cannot be what was written: a checksum, an offset or a count is wrong."""

    code = "corruption"


class UnsupportedVersion(Error, NotImplementedError):
    """The file is of a newer format than this module reads."""

    code = "unsupported_version"


class IoError(Error, OSError):
    """The system, or a server, refused to read or write."""

    code = "io_error"


class ResourceExhausted(Error, MemoryError):
    """The memory that was given, or the disk, is used up."""

    code = "resource_exhausted"


class Cancelled(Error, RuntimeError):
    """The work was stopped. Ctrl-C raises KeyboardInterrupt instead."""

    code = "cancelled"


_BY_CODE = {
    kind.code: kind
    for kind in (InvalidArgument, NotFound, Corruption, UnsupportedVersion, IoError, ResourceExhausted, Cancelled)
}


def _error_of(code: str, message: str, context: str) -> Error:
    """The exception for an error of the engine; the extension module raises it."""
    error = _BY_CODE.get(code, Error)(f"{context}: {message}" if context else message)
    error.code, error.message, error.context = code, message, context
    if isinstance(error, NotFound):
        error.errno, error.filename = errno.ENOENT, context or None
    return error
