"""The pages: the README and those beside the rooms and the studies, as blocks, words and tables."""

import re
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]


class Block(NamedTuple):
    """A fenced block: its language, its text, and the page and line where it begins."""

    kind: str
    text: str
    place: str


class Page:
    """A page by its path."""

    def __init__(self, path: Path):
        self.path, self.name = path, str(path.relative_to(ROOT))
        self.text = path.read_text(encoding="utf-8")

    @cached_property
    def blocks(self) -> list[Block]:
        """Every fenced block, in order."""
        found = re.finditer(r"^```(\w+)\n(.*?)^```$", self.text, re.MULTILINE | re.DOTALL)
        return [
            Block(m[1], m[2], f"{self.name}:{len(self.text[: m.start()].splitlines()) + 1}") for m in found
        ]

    @cached_property
    def words(self) -> str:
        """The page without its fenced blocks."""
        return re.sub(r"^```.*?^```$", "", self.text, flags=re.MULTILINE | re.DOTALL)

    @cached_property
    def headings(self) -> list[str]:
        """Every heading, in order."""
        return re.findall(r"^#+ (.*)$", self.words, re.MULTILINE)


README = Page(ROOT / "README.md")
STUDIES = Page(ROOT / "tests" / "studies" / "README.md")
PAGES = [README, *map(Page, sorted(ROOT.glob("cgff_cli/**/README.md"))), STUDIES]
WORDS = "\n".join(page.words for page in PAGES)


def blocks(kind: str) -> list[Block]:
    """Return the blocks of one language on all pages."""
    return [block for page in PAGES for block in page.blocks if block.kind == kind]


def section(heading: str) -> str:
    """Return what stands below a heading that one page has, as far as the next one of its depth or above."""
    (found,) = [m for page in PAGES for m in re.finditer(rf"(?m)^(#+) {re.escape(heading)}\n", page.words)]
    below = found.string[found.end() :]
    return re.split(rf"(?m)^#{{1,{len(found[1])}}} ", below, maxsplit=1)[0]


def rows(heading: str) -> list[list[str]]:
    """Return the cells of the first table below a heading."""
    table = re.search(r"^\|.*?(?=\n\n|\Z)", section(heading), re.MULTILINE | re.DOTALL)
    assert table, heading
    lines = [line.strip("|").replace(r"\|", "\0").split("|") for line in table[0].strip().splitlines()]
    return [[cell.replace("\0", "|").strip() for cell in line] for line in lines[2:]]


def code_in(*cells: str) -> list[str]:
    """Return what stands between backticks."""
    return [word for cell in cells for word in re.findall(r"`([^`]+)`", cell)]
