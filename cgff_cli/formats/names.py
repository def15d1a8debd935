"""Names for formats that do not allow every character."""

import re
from collections.abc import Iterable


def distinct(names: Iterable[str], unwanted: str, longest: int = 200) -> list[str]:
    """Return names with _ in place of what matches a pattern, no two alike in any case of letters."""
    taken: set[str] = set()
    made = []
    for name in names:
        plain = re.sub(unwanted, "_", name)[:longest] or "_"
        own, number = plain, 1
        while own.lower() in taken:
            number += 1
            own = f"{plain}_{number}"
        taken.add(own.lower())
        made.append(own)
    return made
