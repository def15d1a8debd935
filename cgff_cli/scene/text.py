"""Bytes -> text, and why a file could not be read."""

from errno import EBADF

from cgff_cli.errors import Problem, SceneError

_BOM = b"\xef\xbb\xbf"


def read_text(path: str) -> str:
    """Return the text of a UTF-8 file; raises OSError or ValueError as `open` does, and SceneError."""
    with open(path, "rb") as file:
        return decoded(file.read(), path)


def decoded(data: bytes, path: str) -> str:
    """Return UTF-8 bytes as text without a byte order mark; raises SceneError at the first bad byte."""
    data = data.removeprefix(_BOM)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        message = f"not UTF-8 text: byte 0x{data[error.start]:02x}; save the file as UTF-8"
        raise SceneError([Problem(path, line, column, message)]) from None


def reason(error: Exception) -> str:
    """Return why the system could not read a file, in a few words."""
    if isinstance(error, FileNotFoundError):
        return "no such file"
    if isinstance(error, IsADirectoryError):
        return "it is a directory"
    if isinstance(error, OSError) and error.errno == EBADF:
        return "it is closed"
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return text[:1].lower() + text[1:]
