"""`cgff new`: write a scene of a family. Its commands are made from the families' own parameters."""

import os
from typing import Any

import click

from cgff_cli.cli.common import SectionCommand, SectionOption, TellingCommand, word_options
from cgff_cli.cli.targets import check_targets, files_among
from cgff_cli.errors import OptionError
from cgff_cli.hints import did_you_mean
from cgff_cli.report.files import STDOUT, is_stream, write_output
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.new import Made, find, make
from cgff_cli.scene.parameters import Parameter

MANY = 2000
"""Elements above which a scene file keeps its nodes and elements in tables beside it."""

EPILOG = """\b
Examples:
  cgff new prism --sides 5 --noise 0.1 --seed 1 -o prism.yaml
  cgff new polyhedron --kind cube | cgff solve -
  cgff new net --side 700 --jitter 0.01 -o net.yaml
"""


class FamilyGroup(TellingCommand, click.Group):
    """The families of FAMILIES, each a command made when it is called or asked for help."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the families in the order of FAMILIES."""
        return list(FAMILIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of a family, or None where there is none of that name."""
        return family_command(cmd_name) if cmd_name in FAMILIES else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of families."""
        with formatter.section("Families"):
            formatter.write_dl(list(FAMILIES.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the family; an unknown one is refused with what may have been meant."""
        word = args[0]
        if word not in FAMILIES and not word.startswith("-") and not ctx.resilient_parsing:
            hint = did_you_mean(word, FAMILIES)[2:] or f"there are {', '.join(FAMILIES)}"
            ctx.fail(f"no such family {word!r}; {hint}")
        return super().resolve_command(ctx, args)


@click.group(
    "new",
    cls=FamilyGroup,
    epilog=EPILOG,
    subcommand_metavar="FAMILY [OPTIONS]",
)
@word_options
def command() -> None:
    """Write a scene of a family: prisms, towers, polyhedra, nets, chains.

    Each has a known equilibrium: its file tells the answer where that is in closed form. The same
    options give the same file. `cgff new FAMILY --help` lists the options of a family.
    """


class ParameterType(click.ParamType):
    """A value checked by the rule of a family's parameter."""

    def __init__(self, parameter: Parameter):
        self.parameter = parameter
        self.name = {int: "N", str: "TEXT", float: "X"}[parameter.kind]

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value in the parameter's type; fails saying what is allowed."""
        try:
            return self.parameter.checked(value if self.parameter.kind is str else _number(value))
        except OptionError as error:
            self.fail(str(error), param, ctx)


def _number(value: Any) -> Any:
    for kind in (int, float):
        try:
            return kind(value)
        except (ValueError, OverflowError):
            continue
    return value


def family_command(name: str) -> click.Command:
    """Return the command of one family, its flags read from the signature of its function."""
    family = find(name)

    @click.pass_context
    def write(ctx: click.Context, output: str, tables: bool | None, **values: Any) -> None:
        """Write the scene that the flags describe."""
        given = {key: value for key, value in values.items() if value is not None}
        try:
            _write(make(name, given), output, tables)
        except OptionError as error:
            raise click.UsageError(str(error), ctx) from None

    sections = (("Family", family.own), ("Common", family.common))
    options: list[click.Parameter] = [
        _option(parameter, f"{section} options") for section, own in sections for parameter in own.values()
    ]
    words = FAMILIES[name] + "\n\n" + _details(family.equilibrium.__doc__ or "")
    epilog = "\b\nExamples:\n" + "".join(f"  {example}\n" for example in family.examples)
    made = SectionCommand(
        name, params=[*options, *_output_options()], callback=write, help=words, epilog=epilog
    )
    return word_options(made)


def _details(text: str) -> str:
    """Return a docstring without its first line and without its indentation."""
    return "\n".join(line.removeprefix("    ") for line in text.splitlines()[1:]).strip()


def _option(parameter: Parameter, section: str) -> click.Option:
    choices = parameter.rule.choices
    text = parameter.rule.help
    default = "" if parameter.default is None else f" Default: {parameter.default}."
    ending = "" if text.endswith(".") else "."
    return SectionOption(
        [parameter.flag, parameter.name],
        section=section,
        type=click.Choice(choices) if choices else ParameterType(parameter),
        metavar=None if choices else ParameterType(parameter).name,
        help=f"{text[0].upper()}{text[1:]}{ending}{default}",
    )


def _output_options() -> list[click.Parameter]:
    return [
        SectionOption(
            ["-o", "--output"],
            section="Output",
            metavar="FILE",
            type=click.Path(allow_dash=True),
            default=STDOUT,
            help="Write the scene to FILE (.yaml or .yml). Default: standard output.",
        ),
        SectionOption(
            ["--tables/--no-tables"],
            section="Output",
            default=None,
            help="Keep nodes and elements in FILE.nodes.csv and FILE.elements.csv, named without the "
            f".yaml. Default: above {MANY} elements, if -o is given.",
        ),
    ]


def _write(made: Made, output: str, tables: bool | None) -> None:
    """Write a scene; its tables come first, so that a scene file never names one that is missing."""
    from cgff_cli.scene.tables_out import element_table, node_table
    from cgff_cli.scene.write import to_yaml

    stem, suffix = os.path.splitext(output)
    streamed = output == STDOUT or is_stream(output)
    if not streamed and suffix.lower() not in (".yaml", ".yml"):
        raise click.UsageError(f"-o {output}: the name of a scene must end in .yaml or .yml")
    if streamed and tables:
        raise click.UsageError("--tables needs -o FILE.yaml, beside which the tables are written")
    tabled = not streamed and (made.scene.element_count > MANY if tables is None else tables)
    files = {f"{stem}.nodes.csv": node_table, f"{stem}.elements.csv": element_table} if tabled else {}
    tables_and_scene = [*((path, "a table") for path in files), (output, "the scene")]
    check_targets(files_among(tables_and_scene), ())
    if not tabled:
        write_output(output, [to_yaml(made.scene, made.header)])
        return
    for path, table in files.items():
        write_output(path, table(made.scene))
    nodes, elements = map(os.path.basename, files)
    write_output(output, [to_yaml(made.scene, made.header, (nodes, elements))])
