"""Pictures of the campaign from its tables; without a folder from the tables of the book."""

from __future__ import annotations

import csv
import sys
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator

sys.path.append(str(Path(__file__).resolve().parent))
import campaign  # noqa: E402
import table  # noqa: E402
from campaign import Case, Keys  # noqa: E402

Rows = dict[tuple[str, int, str], dict[str, Any]]
NAMES = {"l1_fig4": "L1 error on Fig. 4's line", "l1_fig5": "L1 error on Fig. 5's line"}
# The methods that a first look needs.
FEW = ("paper's setting", "hex20", "default at 0.98", "Tchamwa–Wielgosz 0.95, H' = 0.8")
LAWS = {"penalty": "explicit penalty", "energy_controlled": "energy-controlled (default)"}


def load(folder: Path = table.BOOK) -> Rows:
    """Rows of completed runs, by scene, mesh and setting."""
    return {
        (row["scene"], int(row["cells"]), row["setting"]): row
        for row in table.read(folder / "accuracy.csv")
        if row["status"] == "done"
    }


def values(rows: Rows, cases: Iterable[Case], *columns: str) -> list[np.ndarray]:
    """The columns of the cases that the table has."""
    found = [rows[own.name] for own in cases if own.name in rows]
    return [np.array([row[name] for row in found], float) for name in columns]


def meshes(rows: Rows, scene: str, keys: Keys) -> list[Case]:
    """A method on all meshes of the table, from coarse to fine."""
    cells = sorted({name[1] for name in rows})
    own = (campaign.case(scene, n, keys) for n in cells)
    return [case for case in own if case.name in rows]


def front(cost: Any, error: Any) -> np.ndarray:
    """Indices of the Pareto front, cheapest first: no other point has at most this cost and a smaller
    error, or at most this error and a smaller cost."""
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    order, best, out = np.lexsort((error, cost)), np.inf, []
    for i in order:
        if error[i] < best:
            out.append(int(i))
            best = error[i]
    return np.array(out, int)


def best_buy(rows: Rows, scene: str = "reference") -> tuple[str, dict[str, Any]]:
    """The method and row with the least seconds among the unfiltered ones whose mean errors on both lines
    are at most the paper's."""
    paper = rows[campaign.case(scene, 100, campaign.PAPER).name]
    good = [
        (method, rows[own.name])
        for method, keys in campaign.METHODS.items()
        for own in meshes(rows, scene, keys)
        if "output.filter" not in keys
        and all(rows[own.name][name] <= paper[name] for name in NAMES)
    ]
    return min(good, key=lambda one: one[1]["times_paper"])


def tidy(ax: Axes, **labels: Any) -> None:
    ax.set(**labels)
    ax.grid(alpha=0.3, which="major")
    ax.spines[["top", "right"]].set_visible(False)


def work(
    folder: Path = table.BOOK,
    cost: str = "times_paper",
    scene: str = "reference",
    named: Collection[str] = tuple(campaign.METHODS),
) -> Figure:
    """Error against cost, one curve per method, with the Pareto front, the paper's point and the best
    buy. The legend has the methods that are named; the others are grey."""
    rows = load(folder)
    figure = Figure(figsize=(7.5, 7.4), layout="constrained")
    paper = rows[campaign.case(scene, 100, campaign.PAPER).name]
    name, best = best_buy(rows, scene)
    for ax, (column, label) in zip(figure.subplots(1, 2), NAMES.items()):
        points = []
        for method, keys in campaign.METHODS.items():
            x, y = values(rows, meshes(rows, scene, keys), cost, column)
            points += list(zip(x, y))
            style = {"color": "0.55", "lw": 0.6, "zorder": 1.5}
            if method in named:
                k = list(named).index(method)
                style = {"marker": "osv^D<>phX"[k % 10], "ms": 5, "lw": 1.3, "color": f"C{k % 10}"}
                style |= {"ls": "-" if k < 10 else "--", "label": method}
            ax.loglog(x, y, **style)
        x, y = np.array(points).T
        edge = front(x, y)
        ax.step(
            x[edge],
            y[edge],
            where="post",
            color="0.55",
            alpha=0.4,
            lw=7,
            zorder=0,
            label="Pareto front",
            solid_joinstyle="round",
        )
        for row, text, place in (
            (paper, "the paper, d/100", (0.97, 0.9)),
            (best, f"best buy:\n{name},\nd/{best['cells']:.0f}", (0.03, 0.06)),
        ):
            ax.plot(row[cost], row[column], "*", ms=17, mfc="none", mec="k", mew=1.2, zorder=5)
            ax.annotate(
                text,
                (row[cost], row[column]),
                xytext=place,
                textcoords="axes fraction",
                ha="right" if place[0] > 0.5 else "left",
                fontsize=9,
                arrowprops={"arrowstyle": "-", "color": "0.5", "lw": 0.8, "shrinkB": 8},
            )
        unit = "seconds" if cost == "times_paper" else "element updates"
        tidy(ax, xlabel=f"{unit} over the paper's", ylabel=label)
        plain = FuncFormatter(lambda value, _: f"{value:g}")
        ax.xaxis.set_major_formatter(plain)
        ax.yaxis.set_major_formatter(plain)
        ax.yaxis.set_minor_locator(LogLocator(subs=(2, 3, 5)))
        ax.yaxis.set_minor_formatter(plain)
    figure.legend(
        *ax.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False
    )
    return figure


def few(folder: Path = table.BOOK) -> Figure:
    """The same; only few curves have names."""
    return work(folder, named=FEW)


def growth(folder: Path = table.BOOK) -> Figure:
    """Element updates and seconds against 1/h, with the theoretical power."""
    rows = load(folder)
    figure = Figure(figsize=(7.5, 4.4), layout="constrained")
    for ax, column, label in zip(
        figure.subplots(1, 2),
        ("updates", "seconds"),
        ("element updates", "seconds of the time loop"),
    ):
        for k, method in enumerate(("paper's setting", "default at 0.98")):
            for scene, style in (("reference", "o-"), ("contact", "s--")):
                x, y = values(rows, meshes(rows, scene, campaign.METHODS[method]), "cells", column)
                shown = {"reference": "plate on a wall", "contact": "two plates"}[scene]
                ax.loglog(x, y, style, color=f"C{k}", ms=5, label=f"{method}, {shown}")
                if scene == "reference" and k == 0:
                    ax.loglog(x, y[-1] * (x / x[-1]) ** 3 / 2.5, "k:", label="slope d + 1 = 3")
        tidy(ax, xlabel="elements over half the thickness, d/h", ylabel=label)
        ax.set_xticks(x, [f"{n:.0f}" for n in x])
        ax.minorticks_off()
    figure.legend(
        *ax.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False
    )
    return figure


def contact(folder: Path = table.BOOK) -> Figure:
    """Penetration and error of the contact against the penalty, for each law and two steps."""
    rows, cells = load(folder), campaign.LAW_CELLS
    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    axes = figure.subplots(1, 2)
    for k, (law, name) in enumerate(LAWS.items()):
        for fraction, style in ((0.3, "o--"), (0.98, "s-")):
            keys = [
                {"contact.enforcement": law, "contact.beta": beta, "time.fraction": fraction}
                for beta in campaign.BETAS
            ]
            own = [rows.get(campaign.case("contact", cells, one).name) for one in keys]
            grows = np.array([row is not None and row["growth"] > 0.01 for row in own])
            for ax, column in zip(axes, ("depth", "contact_l1")):
                y = np.array([row[column] if row else np.nan for row in own])
                x, colour = np.array(campaign.BETAS), {"color": f"C{k}"}
                ax.loglog(x, y, style, ms=5, label=f"{name}, {fraction:g} of its step", **colour)
                ax.plot(x[grows], y[grows], "o", ms=12, mfc="none", mec="tab:red")
    axes[0].plot([], [], "o", ms=12, mfc="none", mec="tab:red", label="energy grows by over 1 %")
    tidy(axes[0], xlabel="penalty factor β", ylabel="deepest contact point / h")
    tidy(axes[1], xlabel="penalty factor β", ylabel="error of the contact on Fig. 4's line")
    figure.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False
    )
    return figure


def search(folder: Path = table.BOOK) -> Figure:
    """Error of the closest point against evaluations of f, one curve per method over its tolerances."""
    rows = table.read(folder / "accuracy_search.csv")
    figure = Figure(figsize=(7.5, 4.2), layout="constrained")
    ax = figure.subplots()
    for k, name in enumerate(dict.fromkeys(row["method"] for row in rows)):
        own = [row for row in rows if row["method"] == name]
        x = np.array([row["evaluations"] for row in own])
        y = np.maximum([row["xi_error"] for row in own], 1e-17)
        style = {"marker": "osv^D<>phX*P"[k % 12], "ms": 4, "lw": 1.2, "color": f"C{k % 10}"}
        style["ls"] = "-" if k < 10 else "--"
        ax.loglog(x, y, label=name.replace("_", " "), **style)
    tidy(ax, xlabel="evaluations of f per point", ylabel="error of the closest point in ξ, median")
    ax.legend(fontsize=9, frameon=False, bbox_to_anchor=(1.0, 1.0), loc="upper left")
    return figure


WORDS = {
    "time.courant": "Courant number {:g}",
    "time.fraction": "{:g} of the stable step",
    "time.integrator": "{}",
    "time.integrator_parameter": "{:g}",
    "body.integration": "one-point hex8",
    "body.element": "{}",
    "viscosity.linear": "bulk viscosity {:g}",
    "viscosity.quadratic": "{:g}",
    "output.filter": "picture filtered, passes: {}",
    "contact.enforcement": "{}",
    "contact.beta": "β = {:g}",
    "contact.points": "{} points",
    "contact.method": "search: {}",
    "contact.tolerance": "to {:g}",
}


def label(change: Keys) -> str:
    """The label of a change of one factor in a picture."""
    return ", ".join(WORDS[name].format(value).replace("_", " ") for name, value in change.items())


def factors(folder: Path = table.BOOK) -> Figure:
    """Cost and errors after the change of one factor, over those of the centre, for both centres."""
    rows = load(folder)
    sizes = [n for n in (200, 100, 12) if any(name[1] == n for name in rows)]
    changes = [("reference", own) for found in campaign.FACTORS.values() for own in found] + [
        ("contact", own) for found in campaign.CONTACT_FACTORS.values() for own in found
    ]
    figure = Figure(figsize=(7.5, 8.6), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for ax, (name, centre) in zip(axes, campaign.CENTRES.items()):
        for place, (scene, change) in enumerate(changes):
            for cells in sizes:
                base = rows.get(campaign.case(scene, cells, centre).name)
                own = rows.get(campaign.case(scene, cells, campaign.over(centre, change)).name)
                if base and own:
                    break
            else:
                ax.text(1.15, place, "ends with an error", va="center", fontsize=9, color="0.5")
                continue
            ratios = [own[column] / base[column] for column in ("times_paper", *NAMES)]
            for ratio, marker, colour in zip(ratios, "|os", ("k", "C0", "C1")):
                ax.plot(ratio, place, marker, color=colour, ms=12 if marker == "|" else 6, mew=2)
        ax.axvline(1.0, color="0.6", lw=1, zorder=0)
        tidy(ax, xscale="log", xlabel="over that of the centre", title=f"from: {name}")
    axes[0].set_yticks(range(len(changes)), [label(change) for _, change in changes], fontsize=9)
    axes[0].invert_yaxis()
    for marker, colour, text in zip("|os", ("k", "C0", "C1"), ("seconds", *NAMES.values())):
        axes[0].plot([], [], marker, color=colour, mew=2, label=text)
    figure.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False
    )
    return figure


def counts(folder: Path = table.BOOK) -> dict[str, float]:
    """Instructions of a method's element update over those of the central difference near its limit, on
    the finest mesh with counts."""
    rows = table.read(folder / "accuracy_instructions.csv")
    finest = max((row["cells"] for row in rows), default=0)
    return {row["method"]: row["over_plain"] for row in rows if row["cells"] == finest}


def price_list(rows: Rows, folder: Path = table.BOOK) -> list[dict[str, str]]:
    """One line per method: its errors and its cost for the plate on a wall."""
    out, each = [], counts(folder)
    for method, keys in campaign.METHODS.items():
        row = rows[campaign.case("reference", 100, keys).name]
        out.append(
            {
                "method": method,
                "Fig. 4": f"{row['l1_fig4']:.4f}",
                "Fig. 5": f"{row['l1_fig5']:.4f}",
                "own level": f"{row['l1_fig5_level']:.4f}",
                "σx": f"{row['l1_sigma_x']:.4f}",
                "σz": f"{row['l1_sigma_z']:.4f}",
                "vx": f"{row['l1_v_x']:.4f}",
                "overshoot": f"{100 * row['overshoot']:.1f} %",
                "width / h": f"{row['width']:.1f}",
                "late / h": f"{row['late']:+.2f}",
                "variation x": f"{row['variation_fig5']:.2f}",
                "variation z": f"{row['variation_along']:.2f}",
                "steps": f"{row['steps']:.0f}",
                "updates": f"{row['cost']:.3g}",
                "instructions": f"{each.get(method, np.nan):.2f}",
                "time": f"{row['times_paper']:.2g}",
            }
        )
    return out


class Point(NamedTuple):
    """A method on a mesh, two plates in contact."""

    method: str
    row: dict[str, Any]
    equivalents: float  # updates over the paper's, weighted with their instructions if these exceed a plain update's

    def over(self, limits: dict[str, float]) -> dict[str, float]:
        """The larger of the mean error and the error at 0.56, over a limit, for each line."""
        return {
            name: max(self.row[name], self.row[f"{name}_at_056"]) / limits[name] for name in NAMES
        }


def points(rows: Rows, nu: float, folder: Path = table.BOOK) -> list[Point]:
    each, out = counts(folder), []
    for method, keys in campaign.METHODS.items():
        own = keys if nu == 0.3 else campaign.with_poisson(keys, nu)
        for case in meshes(rows, "contact", own):
            row = rows[case.name]
            out.append(Point(method, row, row["cost"] * max(1.0, each.get(method, 1.0))))
    return out


def limits(rows: Rows, nu: float) -> dict[str, float]:
    """Errors of the paper's setting at 0.56, plate on a wall."""
    keys = campaign.PAPER if nu == 0.3 else campaign.with_poisson(campaign.PAPER, nu)
    paper = rows[campaign.case("reference", 100, keys).name]
    return {name: paper[f"{name}_at_056"] for name in NAMES}


def bargains(rows: Rows, folder: Path = table.BOOK) -> list[dict[str, str]]:
    """
    For each Poisson's ratio the contact run with the least seconds that is as accurate as the paper's
    setting at its most favourable time, the same without filter, and the most accurate run that costs no
    more than the paper's.
    """
    out = []
    for nu in (0.3, *campaign.POISSON):
        try:
            limit, found = limits(rows, nu), points(rows, nu, folder)
        except KeyError:
            continue
        good = [own for own in found if max(own.over(limit).values()) <= 1]
        within = [own for own in found if own.equivalents <= 1]
        raw = [own for own in good if "output.filter" not in campaign.METHODS[own.method]]
        cheap, cheap_raw = (
            min(some, key=lambda own: own.row["times_paper"], default=None) for some in (good, raw)
        )
        best = min(
            within,
            key=lambda own: max(6 * own.over(limit)["l1_fig4"], 4 * own.over(limit)["l1_fig5"]),
            default=None,
        )
        for what, own in (
            ("as good as the paper", cheap),
            ("as good, picture not filtered", cheap_raw),
            ("as expensive as the paper", best),
        ):
            if own is None:
                continue
            ratio = own.over(limit)
            out.append(
                {
                    "ν": f"{nu:g}",
                    "": what,
                    "method": own.method,
                    "mesh": f"d/{own.row['cells']:.0f}",
                    "Fig. 4, mean": f"{own.row['l1_fig4']:.4f}",
                    "Fig. 4, 0.56": f"{own.row['l1_fig4_at_056']:.4f}",
                    "over the paper's": f"1/{1 / ratio['l1_fig4']:.1f}",
                    "Fig. 5, mean": f"{own.row['l1_fig5']:.4f}",
                    "Fig. 5, 0.56": f"{own.row['l1_fig5_at_056']:.4f}",
                    "over the paper's, too": f"1/{1 / ratio['l1_fig5']:.1f}",
                    "updates": f"1/{1 / own.equivalents:.3g}",
                    "time": f"1/{1 / own.row['times_paper']:.3g}",
                }
            )
    return out


def write_lists(level: str, folder: Path) -> None:
    """The price list of the chapter, and the machine of its table."""
    rows = load(folder)
    places = {
        (row["machine"], row["compiler"], row["flags"], row["commit"]) for row in rows.values()
    }
    made = [
        dict(zip(("level", "machine", "compiler", "flags", "commit"), (level, *map(str, place))))
        for place in sorted(places, key=str)
    ]
    for name, lines in (
        ("accuracy_prices", price_list(rows, folder)),
        ("accuracy_bargains", bargains(rows, folder)),
        ("accuracy_made", made),
    ):
        write_list(folder / f"{name}.csv", lines)


def write_list(path: Path, lines: list[dict[str, str]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, list(lines[0]), lineterminator="\n")
        out.writeheader()
        out.writerows(lines)


PICTURES = {
    "work": work,
    "growth": growth,
    "contact": contact,
    "search": search,
    "factors": factors,
}


def draw(folder: Path) -> None:
    """Draw all pictures from the tables of a folder into it."""
    for name, picture in PICTURES.items():
        picture(folder).savefig(folder / f"{name}.png", dpi=150)
