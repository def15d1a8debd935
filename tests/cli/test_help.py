"""Every command and every option is documented, with an example."""

import re

import pytest

from cgff_cli import __version__
from cgff_cli.cli import COMMANDS, main
from cgff_cli.options import OPTIONS
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


def test_no_command_prints_the_help(run: Run):
    assert "Commands:" in run().output


def _command(name: str):
    return main.get_command(None, name)  # type: ignore[arg-type]
