"""Form-finding of tensegrity structures and cable nets by nonlinear conjugate gradients.

    import cgff_cli
    result = cgff_cli.solve(cgff_cli.load("prism.yaml"), tolerance=1e-12)
    result.verdict, result.nodes["t1"], result.analysis["stable"]

Names are loaded on first use, so that `import cgff_cli` and `cgff --help` cost nothing.
"""

from importlib import import_module

__version__ = "0.1.0"
TOOL = {"name": "cgff", "version": __version__}

_HOME = {
    "load": "cgff_cli.scene.read",
    "loads": "cgff_cli.scene.read",
    "from_dict": "cgff_cli.scene.read",
    "to_yaml": "cgff_cli.scene.write",
    "new": "cgff_cli.scene.new",
    "solve": "cgff_cli.pipeline",
    "solve_cases": "cgff_cli.cases",
    "solve_many": "cgff_cli.many",
    "analyse": "cgff_cli.as_given",
    "prestress": "cgff_cli.rest_lengths",
    "compare": "cgff_cli.study.compare",
    "convert": "cgff_cli.formats.convert",
    "equilibria": "cgff_cli.study.search",
    "sweep": "cgff_cli.study.rows",
    "shipped": "cgff_cli.scene.read",
    "Scene": "cgff_cli.scene.scene",
    "Group": "cgff_cli.scene.scene",
    "Result": "cgff_cli.result",
    "SolveOptions": "cgff_cli.options",
    "CgffError": "cgff_cli.errors",
    "SceneError": "cgff_cli.errors",
    "OptionError": "cgff_cli.errors",
}

__all__ = [*_HOME, "__version__"]


def __getattr__(name: str) -> object:
    if name in _HOME:
        globals()[name] = found = getattr(import_module(_HOME[name]), name)
        return found
    raise AttributeError(f"module 'cgff_cli' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
