"""Iterations of every --cg-beta on the shipped scenes: both objectives, with the preconditioner and without.

python tests/studies/beta_rules.py
"""

from pathlib import Path

import cgff_cli
from cgff_cli.solvers.directions import RULES

SCENES = sorted((Path(__file__).parents[2] / "structures").glob("*.yaml"))
MOST = 5000


def told(path: Path, rule: str, objective: str, preconditioner: str) -> str:
    """Return the iterations to 1e-10, with a * where the answer is not stable, or why there is none."""
    options = {"objective": objective, "preconditioner": preconditioner, "max_iterations": MOST}
    result = cgff_cli.solve(str(path), cg_beta=rule, tolerance=1e-10, **options)
    if not result.converged:
        return "-"
    return f"{result.counts['iterations']}{'' if result.analysis['stable'] else '*'}"


def main() -> None:
    print("| objective | preconditioner | scene |", " | ".join(RULES), "|")
    print("|---|---|---|" + "--:|" * len(RULES))
    for objective in ("energy", "residual"):
        for preconditioner in ("none", "tangent"):
            for path in SCENES:
                cells = [told(path, rule, objective, preconditioner) for rule in RULES]
                print(f"| {objective} | {preconditioner} | {path.stem} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
