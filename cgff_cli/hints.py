"""Words for people: the names most like one that does not exist, lists, counts."""

from collections.abc import Collection, Iterable, Sequence

_POOL = 1000
NAMED = 3  # more names that are equally near are no hint


def nearest(name: str, candidates: Iterable[str]) -> list[str]:
    """Return those of the candidates that are most like a name, all equally; none where none is near."""
    from difflib import SequenceMatcher

    pool = [word for word in candidates if abs(len(word) - len(name)) <= 1 + len(name) // 3]
    if len(pool) > _POOL:
        pool = [word for word in pool if word[:3] == name[:3]][:_POOL]
    matcher = SequenceMatcher(None, "", name.lower(), autojunk=False)
    best: list[str] = []
    score = 0.6 if len(name) > 2 else 0.5
    for word in pool:
        matcher.set_seq1(word.lower())
        ratio = matcher.ratio() if matcher.quick_ratio() >= score else 0.0
        if ratio >= score:
            best = [*best, word] if ratio == score else [word]
            score = ratio
    return best


def did_you_mean(name: str, candidates: Collection[str], otherwise: str = "") -> str:
    """Return "; did you mean 'x' or 'y'?", or nothing where no candidate is near, or too many are.

    otherwise : what introduces a list of all there are, to be given in place of nothing, as "allowed:"
    """
    near = nearest(name, candidates)
    if 0 < len(near) <= NAMED:
        return f"; did you mean {either(list(map(repr, near)))}?"
    return f"; {otherwise} {', '.join(candidates)}" if otherwise else ""


def meant_or_all(name: str, candidates: Collection[str]) -> str:
    """Return "; did you mean 'x'?", or all that is allowed where no candidate is near."""
    return did_you_mean(name, candidates) or f"; allowed: {', '.join(candidates)}"


def either(words: Sequence[str], joint: str = "or") -> str:
    """Return words as a list for people: a, b or c."""
    *others, last = words
    return f"{', '.join(others)} {joint} {last}" if others else last


def count(number: int, singular: str, plural: str = "") -> str:
    """Return "no cables", "1 cable" or "2 cables"."""
    return f"{number or 'no'} {singular if number == 1 else plural or singular + 's'}"
