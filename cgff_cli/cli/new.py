"""`cgff new`: write a scene of a family. Its commands are made from the families' own parameters."""

import inspect
import os
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import Decorator, SectionCommand, examples, flag, flags, word_options
from cgff_cli.cli.lazy import LazyGroup
from cgff_cli.cli.options import output_flag, rule_flag
from cgff_cli.cli.targets import check_targets, form_of_file
from cgff_cli.errors import OptionError
from cgff_cli.report.files import STDOUT, write_output
from cgff_cli.scene.families import FAMILIES

if TYPE_CHECKING:
    from cgff_cli.scene.new import Parameter
    from cgff_cli.scene.scene import Scene

MANY = 2000
"""Elements above which a scene file keeps its nodes and elements in tables beside it."""

_SUFFIXES = {".yaml": "", ".yml": ""}

_EPILOG = examples(
    "cgff new prism --sides 5 --noise 0.1 --seed 1 -o prism.yaml",
    "cgff new polyhedron --kind cube | cgff solve -",
)

_output_flags = flags(
    output_flag(
        "-o",
        "--output",
        dash=True,
        default=STDOUT,
        help="Write the scene to FILE (.yaml or .yml). Default: standard output.",
    ),
    flag(
        "--tables/--no-tables",
        section="Output",
        default=None,
        help="Keep nodes and elements in FILE.nodes.csv and FILE.elements.csv, named without the .yaml. "
        f"Default: above {MANY} elements, if -o is given.",
    ),
)


def family_command(name: str) -> click.Command:
    """Return the command of one family, its flags read from the signature of its function."""
    from cgff_cli.scene.new import find, make

    family = find(name)

    @click.pass_context
    def write(ctx: click.Context, output: str, tables: bool | None, **values: Any) -> None:
        """Write the scene that the flags describe."""
        given = {key: value for key, value in values.items() if value is not None}
        try:
            _write(*make(name, given), output, tables)
        except OptionError as error:
            raise click.UsageError(str(error), ctx) from None

    own = [_parameter_flag(parameter, "Family options") for parameter in family.own.values()]
    common = [_parameter_flag(parameter, "Common options") for parameter in family.common.values()]
    details = "\n".join((family.equilibrium.__doc__ or "").splitlines()[1:])
    made = click.command(
        name,
        cls=SectionCommand,
        help=f"{FAMILIES[name]}\n\n{inspect.cleandoc(details)}",
        epilog=examples(*family.examples),
    )
    return made(flags(*own, *common, _output_flags, word_options)(write))


class _Families(LazyGroup):
    """The families of FAMILIES."""

    listed, noun, heading = FAMILIES, "family", "Families"

    def made(self, name: str) -> click.Command:
        """Return the command of a family."""
        return family_command(name)


@click.group("new", cls=_Families, epilog=_EPILOG, subcommand_metavar="FAMILY [OPTIONS]")
@word_options
def command() -> None:
    """Write a scene of a family: prisms, towers, nets and others.

    Each has a known equilibrium: its file tells the answer where that is in closed form. The same
    options give the same file. `cgff new FAMILY --help` lists the options of a family.
    """


def _parameter_flag(own: "Parameter", section: str) -> Decorator[Any]:
    return rule_flag(own.name, own.rule, own.checked, section, own.default)


def _write(scene: "Scene", header: str, output: str, tables: bool | None) -> None:
    """Write a scene; its tables come first, so that a scene file never names one that is missing."""
    from cgff_cli.scene.tables_out import element_table, node_table
    from cgff_cli.scene.write import to_yaml

    streamed = output == STDOUT or form_of_file("-o", output, _SUFFIXES, "the name of a scene") is None
    if streamed and tables:
        raise click.UsageError("--tables needs -o FILE.yaml, beside which the tables are written")
    tabled = not streamed and (scene.element_count > MANY if tables is None else tables)
    stem = os.path.splitext(output)[0]
    paths = (f"{stem}.nodes.csv", f"{stem}.elements.csv")
    wanted = paths if tabled else ()
    check_targets([*((path, "a table") for path in wanted), (output, "the scene")])
    for path, table in zip(wanted, (node_table, element_table), strict=False):
        write_output(path, table(scene))
    names = (os.path.basename(paths[0]), os.path.basename(paths[1])) if tabled else None
    write_output(output, [to_yaml(scene, header, names)])
