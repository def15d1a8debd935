"""`python -m cgff_cli` is the command `cgff`."""

from cgff_cli.cli import main

main(prog_name="cgff")
