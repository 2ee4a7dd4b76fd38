"""The table of docs/start/hosts.rst: ``python tests/hosts/hosts_table.py`` prints it, ``--book`` writes it."""

import csv
import importlib
import re
import sys
from importlib.metadata import version
from pathlib import Path

import calculix
import two_plates as plates

HERE = Path(__file__).parent
BOOK = HERE.parents[1] / "docs" / "start" / "hosts.csv"
HOSTS = {"skfem": "scikit-fem", "ngsolve": "ngsolve", "akantu": "akantu"}
HEAD = [
    "Host",
    "Lines of glue",
    ":math:`\\beta`",
    "Difference from the scene",
    "Rise of energy",
    "Energy at the end",
    "Time of the contact",
]

HEAD_CALCULIX = [
    "Step over :math:`h/c_1`",
    "Stress of CalculiX",
    "Stress of the scene",
    "Displacement of the left plate over that of the scene",
    "of the right plate",
]


def glue(host):
    """The lines of code between the marks, in the host's file and in the loop of two_plates.py if the host uses it."""
    text = (HERE / f"host_{host}.py").read_text()
    if "plates.run_host" in text:
        text += (HERE / "two_plates.py").read_text()
    marked = "".join(re.findall(r"# -- glue\n(.*?)# -- end", text, re.S)).splitlines()
    return len([line for line in marked if line.strip() and not line.strip().startswith('"""')])


def rows(host):
    """A row of the table for each penalty."""
    for beta in plates.FACTORS:
        result = importlib.import_module(f"host_{host}").run(beta)
        shots = zip(result.shots, plates.run_scene(result, beta))
        apart = max(plates.difference(*pair) for pair in shots)
        left = result.energy[-1] / result.energy[0]
        numbers = f"{beta:g}", f"{apart:.0e}", f"{result.rise:.0e}", f"{left:.5f}"
        name = f"{HOSTS[host]} {version(HOSTS[host])}"
        yield [name, glue(host), *numbers, f"{100 * result.share:.0f} %"]


def beside_calculix(courant):
    """The stress behind the front of CalculiX and of the scene, and the ratio of their mean displacements."""
    beta = 4.0
    one = calculix.run(beta, courant)
    other = plates.run_scene(plates.Result(plates.PLATEAU / 40), beta)[0]
    stresses = [plates.stress(X[1], u[1]) for X, u in (one, other)]
    return *stresses, *(
        mine[:, 0].mean() / ours[:, 0].mean() for mine, ours in zip(one[1], other[1])
    )


def write(path, table):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(table)


if __name__ == "__main__":
    hosts, calculix_rows = [HEAD], [HEAD_CALCULIX]
    for host in HOSTS:
        for row in rows(host):
            print(*row, sep=" | ", flush=True)
            hosts.append(row)
    for courant in (0.25, 0.5):
        numbers = [f"{number:.4f}" for number in beside_calculix(courant)]
        print("CalculiX", courant, *numbers, sep=" | ", flush=True)
        calculix_rows.append([courant, *numbers])
    if "--book" in sys.argv:
        write(BOOK, hosts)
        write(BOOK.with_name("hosts_calculix.csv"), calculix_rows)
