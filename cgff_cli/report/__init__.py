"""Sixth room: the one result record and the ways to write it."""
