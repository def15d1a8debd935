"""A cable that hangs by its own weight against the elastic catenary: the order of its links.

    python tests/studies/catenary.py [--links 4,8,16,32,64,128,256]

A cable of unstrained length 12, EA 300 and weight 2 per length between level supports 10 apart, solved to
1e-12. Errors of sag and horizontal pull are relative to Irvine's closed form; the order is that of the step
from half as many links.
"""

import argparse

import numpy as np

from tests.closed_forms.test_weight import LAWS, elastic_catenary, hanging


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--links", default="4,8,16,32,64,128,256")
    counts = list(map(int, parser.parse_args().links.split(",")))
    sag, pull, _ = elastic_catenary(10.0, 12.0, 300.0, 2.0)
    print(f"closed form: sag {sag:.10f}, horizontal pull {pull:.10f}\n")
    print("| law | links | iterations | error of sag | order | error of pull | order |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for law in LAWS:
        last = None
        for links in counts:
            result = hanging(law, links)
            found = -result.coordinates[links // 2, 1], -result.reactions["n0"][0]
            errors = np.array(found) / (sag, pull) - 1.0
            order = ["-"] * 2 if last is None else [f"{own:.2f}" for own in np.log2(last / errors)]
            cells = (f"{errors[0]:.1e}", order[0], f"{errors[1]:.1e}", order[1])
            print(f"| {law} | {links} | {result.counts['iterations']} | {' | '.join(cells)} |")
            last = errors


if __name__ == "__main__":
    main()
