"""What `cgff plot` and `cgff view` do with each file before they draw it."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from cgff_cli.cli.common import ExitCode, say, title, warn_of
from cgff_cli.cli.targets import Named, refuse_inputs

if TYPE_CHECKING:
    from cgff_cli.result import Result


def shown_of(
    path: str, case: str | None, as_given: bool, targets: Sequence[Named]
) -> "Iterator[tuple[Result, ExitCode]]":
    """Yield what is drawn of a file, or of each of its cases, and how its solve ended.

    Warns of it, and says where it did not converge; what was given may be as it is.
    Raises UsageError where a target is a file that the scene was read from, SceneError, OptionError.
    """
    from cgff_cli.report.drawing import results_of

    for result in results_of(path, case, as_given):
        source = result.source
        refuse_inputs(targets, ((own, f"a file of {title(path)}") for own in source.files))
        is_solved = not (as_given or source.is_geometry)
        warn_of(path, (result if is_solved else source).warnings, source.case)
        if not is_solved or source.answer or result.converged:
            yield result, ExitCode.OK
            continue
        say(f"cgff: {title(path)}: {result.message}")
        yield result, ExitCode.INTERRUPTED if result.interrupted else ExitCode.NOT_CONVERGED
