"""The whole command on the prism against a bare import of numpy, click and yaml, as processes.

    python tests/studies/startup.py [--repeat 30]

In turn, so that drift hits both alike; medians of wall time, of an installed `cgff` beside this Python.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PRISM = Path(__file__).parents[2] / "structures" / "prism.yaml"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=30)
    arguments = parser.parse_args()
    cgff = Path(sys.executable).with_name("cgff")
    with tempfile.TemporaryDirectory() as folder:
        commands = {
            "import": [sys.executable, "-c", "import numpy, click, yaml"],
            "cgff": [str(cgff), "solve", str(PRISM), "-o", f"{folder}/out.json"],
            "cgff --help": [str(cgff), "--help"],
        }
        times = {name: [] for name in commands}
        for _ in range(arguments.repeat + 2):
            for name, command in commands.items():
                start = time.perf_counter()
                subprocess.run(command, check=True, capture_output=True)
                times[name].append(time.perf_counter() - start)
    base = statistics.median(times["import"][2:])
    for name, seconds in times.items():
        median = statistics.median(seconds[2:])
        print(f"{name:12} {1e3 * median:7.1f} ms {median / base:6.2f}")


if __name__ == "__main__":
    main()
