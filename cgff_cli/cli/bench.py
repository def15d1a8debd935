"""`cgff bench`: many scenes by several methods, a row per case and method, resumed where it stopped."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    drawn,
    examples,
    failed,
    flag,
    progress,
    say,
    word_options,
    worst,
)
from cgff_cli.cli.comparing import comparing_flags, comparing_options, wanted_methods
from cgff_cli.cli.targets import Named, check_targets, data_outputs
from cgff_cli.report.files import STDOUT, is_stream, write_output

if TYPE_CHECKING:
    from cgff_cli.study.bench import Job
    from cgff_cli.study.machine import Done, Row

_EPILOG = examples(
    "cgff bench -o bench.json",
    "cgff bench suite.yaml prism.yaml --only towers/ --lm --lbfgs --format table",
)

_ONLY = flag(
    "--only",
    section="Cases",
    metavar="WORD",
    multiple=True,
    help="Only cases with WORD in their id; may be repeated.",
)
_AGAIN = flag("--again", section="Cases", is_flag=True, help="Measure anew what FILE.json holds already.")


@click.command("bench", cls=SectionCommand, epilog=_EPILOG)
@click.argument("suites", nargs=-1, metavar="[SUITE|SCENE...]", type=click.Path())
@comparing_flags(
    "all",
    10.0,
    "Write to FILE after every case: .json everything, to go on from when started again; .csv a table.",
    _ONLY,
    _AGAIN,
)
@word_options
@click.pass_context
def command(ctx: click.Context, suites: tuple[str, ...], **values: Any) -> None:
    """Compare methods over many scenes.

    A SUITE is a YAML list of cases, a SCENE a case by itself; without either it takes the suite that comes
    with the program. Started again with the same -o FILE.json, it measures only what is not yet in there
    or has changed: the case, the options, the program or the machine.
    """
    from cgff_cli.study.machine import done

    bench = Bench(suites, values)
    code = ExitCode.OK
    for ended in done(bench.asked, bench.measured, bench.rows):
        code = worst(code, bench.took(ended))
    bench.finish()
    ctx.exit(code)


class Bench:
    """One run of the command: the jobs, the rows there are of them, and where those go.

    jobs  : all cases of the suites; asked : those to be measured in this run
    rows  : digest -> rows
    """

    def __init__(self, suites: tuple[str, ...], values: dict[str, Any]):
        from cgff_cli.study.bench import jobs_of, kept
        from cgff_cli.study.suite import cases_of, standard

        self.path = None if values["output"] == STDOUT else values["output"]
        outputs = data_outputs(values["output_format"], values["output"])
        self.form = outputs[0][1]
        self.table = (STDOUT, "table") in outputs
        self.is_filed = self.path is not None and not is_stream(self.path)
        methods, self.options = wanted_methods(values, "all"), comparing_options(values)
        self.jobs = jobs_of(cases_of(suites or [standard()]), methods, self.options)
        self.options |= {"methods": methods}
        check_targets([(self.path, "the rows")], _inputs(suites, self.jobs))
        self.asked = _selected(self.jobs, values["only"])
        self.rows: dict[str, list[Row]] = {}
        if self.form == "json" and self.is_filed:
            self.rows = kept(str(self.path), self.jobs)
        for job in self.asked if values["again"] else ():
            self.rows.pop(job.digest, None)

    def measured(self, job: "Job") -> "list[Row]":
        """Return the rows of a job, showing on a terminal which run of which case is at work."""
        from cgff_cli.study.bench import measured

        place = f"case {self.asked.index(job) + 1} of {len(self.asked)}"
        with progress(job.case.id, delay=0.0) as line:
            show = None if line is None else lambda *run: line.show(f"{place}, {run[0]}, run {run[1]}")
            return measured(job, show)

    def took(self, ended: "Done") -> ExitCode:
        """Take what became of a job: write what there is so far, and tell how it ended."""
        name = ended.job.case.id
        if ended.error is not None:
            say(f"cgff: {name}: not measured")
        code = failed(ended, name)
        if code is not None:
            return code
        rows = self.rows[ended.job.digest] = ended.found
        if ended.is_new and self.is_filed:
            write_output(str(self.path), self._text())
        if self.table:
            from cgff_cli.report.bench_text import case_page

            write_output(STDOUT, [drawn(case_page(rows)), "\n"])
        return _told(ended.job, rows)

    def finish(self) -> None:
        """Write what takes all rows at once."""
        if self.table and self._found(self.asked):
            from cgff_cli.report.bench_text import all_cases_page

            write_output(STDOUT, [drawn(all_cases_page(self._found(self.asked)))])
        if self.path is not None or not self.table:
            write_output(self.path or STDOUT, self._text())

    def _found(self, jobs: "list[Job]") -> "list[Row]":
        return [row for job in jobs for row in self.rows.get(job.digest, [])]

    def _text(self) -> Iterable[str]:
        """Return the pieces of the file: of all jobs, those not asked for in this run among them."""
        rows = self._found(self.jobs)
        if self.form == "csv":
            from cgff_cli.report.csv_out import bench_table

            return bench_table(rows)
        from cgff_cli.report import json_out
        from cgff_cli.study.bench import record

        return json_out.pretty(record(self.options, rows).items())


def _inputs(suites: Iterable[str], jobs: "Iterable[Job]") -> Iterator[Named]:
    """Yield the files that a bench is read from."""
    yield from ((path, f"the file {path}") for path in suites)
    scenes = (job.scene for job in jobs if job.scene is not None)
    yield from ((path, f"a file of {scene.name}") for scene in scenes for path in scene.files)


def _selected(jobs: "list[Job]", only: tuple[str, ...]) -> "list[Job]":
    """Return the jobs whose id holds one of the words."""
    asked = [job for job in jobs if not only or any(word in job.case.id for word in only)]
    if not asked:
        raise click.UsageError(f"no case has {' or '.join(map(repr, only))} in its id")
    return asked


def _told(job: "Job", rows: "list[Row]") -> ExitCode:
    """Say on standard error where CGFF did not end as it should, and return the exit code."""
    judged = next((row for row in rows if row["as_expected"] is not None), None)
    own = judged or rows[0]
    if own["converged"] if judged is None else own["as_expected"]:
        return ExitCode.OK
    word = f"{own['outcome']} where {job.case.expect['outcome']} is expected" if judged else own["verdict"]
    say(f"cgff: {job.case.id}: {word}: {own['message']}")
    return ExitCode.NOT_CONVERGED
