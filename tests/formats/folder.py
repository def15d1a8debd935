"""The files beside the tests: what other programs take, written from the documentation of their formats."""

from pathlib import Path

FILES = Path(__file__).parent / "files"
