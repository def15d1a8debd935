"""Every command and every option is documented, with an example."""

import re
from pathlib import Path

import click
import pytest

from cgff_cli import __version__
from cgff_cli.cli import COMMANDS, main
from cgff_cli.options import OPTIONS
from cgff_cli.scene.families import FAMILIES
from tests.cli.conftest import Run


def test_the_command_lists_its_commands(run: Run):
    ended = run("--help")
    assert ended.exit_code == 0
    for name, text in COMMANDS.items():
        assert re.search(rf"^ +{name} +{re.escape(text)}$", ended.stdout, re.MULTILINE)
    assert "_CGFF_COMPLETE=bash_source" in ended.stdout


def test_the_version(run: Run):
    assert run("--version").stdout == f"cgff {__version__}\n"


@pytest.mark.parametrize("flag", ["-h", "--help"])
@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_that_names_every_option(run: Run, name: str, flag: str):
    ended = run(name, flag)
    assert ended.exit_code == 0
    for parameter in _command(name).params:
        for option in parameter.opts if parameter.param_type_name == "option" else []:
            assert re.search(rf"(^|\s){option}\b", ended.stdout), option


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_begins_with_the_line_of_the_list_and_ends_with_examples(run: Run, name: str):
    text = run(name, "--help").stdout
    assert text.splitlines()[2].strip() == COMMANDS[name]
    assert re.search(rf"Examples:\n( +.*cgff {name} .+\n)+\Z", text)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_has_a_help_text(name: str):
    for parameter in _command(name).params:
        if parameter.param_type_name == "option":
            assert parameter.help, parameter.opts  # type: ignore[attr-defined]


def test_every_solve_option_is_a_flag_with_its_default(run: Run):
    text = " ".join(run("solve", "--help").stdout.split())
    for name, option in OPTIONS.items():
        flag = f"--{name.replace('_', '-')} "
        own = text[text.index(flag) :]
        assert f"Default: {option.default}." in own.split(" --", 1)[0]
        for value in option.metadata.get("allowed", ()):
            assert value in own.split(" --", 1)[0]


@pytest.mark.parametrize("name", [*COMMANDS, *(f"new {family}" for family in FAMILIES)])
def test_a_flag_that_takes_one_value_refuses_a_second(run: Run, name: str):
    single = [own.opts[0] for own in _options(name) if not (own.is_flag or own.multiple)]
    assert single or name == "new"
    for flag in single:
        ended = run(*name.split(), flag, "1", flag, "2")
        assert (ended.exit_code, ended.stdout) == (2, ""), flag
        assert f"{flag} takes one value, got '1' and '2'\n" in ended.stderr


def test_the_second_case_is_refused_whichever_way_it_is_written(run: Run):
    ended = run("solve", "prism.yaml", "--case=wind", "--case", "uls", "--case", "dead")
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert "--case takes one value, got 'wind', 'uls' and 'dead'\n" in ended.stderr
    assert "-o takes one value" in run("solve", "prism.yaml", "-o", "a.json", "--output", "b.json").stderr
    assert not list(Path().glob("*.json"))


def test_no_command_prints_the_help(run: Run):
    assert "Commands:" in run().output


def _command(name: str):
    return main.get_command(None, name)  # type: ignore[arg-type]


def _options(name: str) -> list[click.Option]:
    """Return the options of a command, or of one below it as `new prism`."""
    command: click.Command = main
    for word in name.split():
        command = command.get_command(None, word)  # type: ignore[attr-defined]
    return [own for own in command.params if isinstance(own, click.Option)]
