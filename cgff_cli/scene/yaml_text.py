"""YAML text -> its events, or what is wrong with its form.

PyYAML finds the mistake and says it in words that depend on its version and on libyaml. The words here
depend on nothing but the text. Brackets are those of YAML and JSON alike.
"""

import re
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from cgff_cli.scene.findings import quoted
from cgff_cli.scene.located import DEPTH, FormError, mark_of

_PARTS = re.compile(r"""(?<![^\s,:\[{])(?:"(?:[^"\\]|\\.)*"|'[^']*'|\#[^\n]*)|[][{}]""")
CLOSING = {"[": "]", "{": "}"}
_LEVELS = {"[": 1, "{": 1, "]": -1, "}": -1}

Brackets = Iterator[tuple[int, str]]

_NOT_TEXT = "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"

_ENDINGS = {
    "mapping values are not allowed": " in this context",
    "found incompatible YAML document": "",
    "while parsing a block mapping": ": did not find expected key",
    "while parsing a block collection": ": did not find expected '-' indicator",
}
"""How a message of any version begins -> how it ends here."""


def yaml_events(text: str) -> Iterator[Any]:
    """Yield the YAML events of a text; raises FormError where it is not YAML."""
    import yaml

    nests: dict[Any, int] = {yaml.MappingStartEvent: 1, yaml.SequenceStartEvent: 1}
    nests |= {yaml.MappingEndEvent: -1, yaml.SequenceEndEvent: -1}
    depth, event = 0, None
    try:
        for event in yaml.parse(text, Loader=_loader()):
            depth += nests.get(type(event), 0)
            yield event
    except yaml.MarkedYAMLError as error:
        _refuse_depth(text, depth, event, error)
        offset, message = _fault(text, error)
        raise FormError(mark_of(text, offset), f"not valid YAML: {message}") from None
    except (yaml.YAMLError, UnicodeEncodeError):
        found = re.search(_NOT_TEXT, text)
        if found is None:
            raise
        message = f"character U+{ord(found.group()):04X} is not allowed in a scene file"
        raise FormError(mark_of(text, found.start()), message) from None


def _refuse_depth(text: str, depth: int, last: Any, error: Any) -> None:
    """Raise FormError where the brackets between the last event and an error nest too deep.

    A parser reads ahead of its events and may refuse depth before we see it; depth: that of the last event.
    """
    start = _offset(text, last and last.end_mark)
    end = _offset(text, error.context_mark or error.problem_mark)
    at = deeper(brackets(text, start, end + 1), DEPTH - depth)
    if at is not None:
        raise FormError(mark_of(text, at), f"nested deeper than {DEPTH} levels")


def _loader() -> Any:
    import yaml

    return getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def _fault(text: str, error: Any) -> tuple[int, str]:
    """Return where a text stops being YAML, or where what is not finished was begun, and why."""
    at = _offset(text, error.problem_mark or error.context_mark)
    begun = _offset(text, error.context_mark) if error.context_mark else at
    context = error.context or ""
    if text[at : at + 1] == "\t":
        return at, "a tab cannot indent; use spaces"
    bracket = _bracket_around(text, at) if context.startswith("while parsing a flow") else None
    if bracket is not None:
        return _in_brackets(text, bracket, at)
    if "quoted scalar" in context:
        return _in_quotes(text, begun, at)
    if context.startswith("while scanning a simple key"):
        return begun, _colon_missing(text, begun)
    if "cannot start any token" in error.problem:
        return at, f"{text[at]!r} cannot begin a word; put the word in quotes"
    if "<document start>" in error.problem:
        return at, "the scene has ended before this; is its first line indented too deep?"
    if text[at : at + 1] in ("]", "}"):
        return at, f"{text[at]!r} closes nothing"
    return _quote_before(text, at) or _text_goes_on(text, at, error.problem) or (at, _words(error))


def _offset(text: str, mark: Any) -> int:
    return min(mark.index, len(text)) if mark else 0


def _tokens(text: str, end: int) -> Iterator[Any]:
    """Yield the YAML tokens before an offset, as far as there are any."""
    import yaml

    with suppress(yaml.YAMLError):
        for token in yaml.scan(text, Loader=_loader()):
            if token.start_mark.index >= end:
                break
            yield token


def _bracket_around(text: str, at: int) -> int | None:
    """Return the offset of the innermost bracket that is open at an offset."""
    opened: list[int] = []
    for token in _tokens(text, at):
        kind = type(token).__name__
        if kind in ("FlowSequenceStartToken", "FlowMappingStartToken"):
            opened.append(token.start_mark.index)
        elif opened and kind in ("FlowSequenceEndToken", "FlowMappingEndToken"):
            opened.pop()
    return opened[-1] if opened else None


def _in_brackets(text: str, begun: int, at: int) -> tuple[int, str]:
    if innermost(brackets(text, begun, len(text))) is not None:
        return begun, f"the {text[begun]!r} opened here is not closed"
    comma = "a value" if text[at : at + 1] == "," else "','"
    line = mark_of(text, begun)[0]
    return at, f"expected {comma} or {CLOSING[text[begun]]!r}; the {text[begun]!r} stands on line {line}"


def _in_quotes(text: str, begun: int, at: int) -> tuple[int, str]:
    escape = text.rfind("\\", begun, at + 1)
    if escape < 0 or text[at:].isspace() or at == len(text):
        return begun, "the quote opened here is not closed"
    return escape, "a backslash in double quotes must be doubled; single quotes take it as it is"


def _colon_missing(text: str, begun: int) -> str:
    line = re.split(r"\s#|\n", text[begun:], maxsplit=1)[0].strip()
    if re.match(r"[\w-]+:\S", line):
        return f"a blank must follow the colon in {quoted(line)}"
    return f"a colon is missing in {quoted(line)}"


def _text_goes_on(text: str, at: int, problem: str) -> tuple[int, str] | None:
    """Return why a key is read as more of the text before it, or None where it is not."""
    begin = text.rfind("\n", 0, at) + 1
    before = text[:begin].rstrip()
    if not problem.startswith("mapping values") or not before or re.search(r":\s", text[begin:at]):
        return None
    above = before.rfind("\n") + 1
    line = before[above:].lstrip()
    if not re.search(r":(\s|$)", line) and line[0] not in "-#":
        return len(before) - len(line), _colon_missing(text, len(before) - len(line))
    key = begin + len(text[begin:at]) - len(text[begin:at].lstrip())
    if key - begin <= len(before) - above - len(line):
        return None
    return key, f"indented deeper than line {mark_of(text, above)[0]}, which holds no mapping"


def _quote_before(text: str, at: int) -> tuple[int, str] | None:
    """Return where the quoted text begins that ends right before an offset, as a quote too early ends it."""
    if text[:at].rstrip()[-1:] not in ("'", '"'):
        return None
    last = None
    for last in _tokens(text, at):  # noqa: B007
        pass
    if last is None or getattr(last, "style", None) not in ("'", '"'):
        return None
    begun = last.start_mark.index
    return begun, f"the quote opened here is closed on line {last.end_mark.line + 1}, but more follows"


def _words(error: Any) -> str:
    said = f"{error.context}: {error.problem}" if error.context else str(error.problem)
    return next((begin + end for begin, end in _ENDINGS.items() if said.startswith(begin)), said)


def brackets(text: str, start: int, end: int) -> Brackets:
    """Yield (offset, bracket) of every bracket outside quotes and comments."""
    for part in _PARTS.finditer(text, start, end):
        if part.group() in _LEVELS:
            yield part.start(), part.group()


def innermost(brackets: Brackets) -> int | None:
    """Return the offset of the innermost bracket still open behind all, or closed by one of another kind.

    None where the first one is closed before the end.
    """
    opened: list[tuple[int, str]] = []
    for offset, mark in brackets:
        if mark in CLOSING:
            opened.append((offset, mark))
            continue
        if not opened or CLOSING[opened[-1][1]] != mark:
            break
        opened.pop()
        if not opened:
            return None
    return opened[-1][0] if opened else None


def deeper(brackets: Brackets, levels: int) -> int | None:
    """Return the offset of the first bracket that opens more than so many levels, or None."""
    for offset, mark in brackets:
        levels -= _LEVELS[mark]
        if levels < 0:
            return offset
    return None
