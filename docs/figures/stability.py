"""Pictures of the stability laboratory, from the tables of its chapter."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, VIOLET

import libcontact as ct

TABLES = Path(__file__).resolve().parents[1] / "stability"
COLOURS = {"energy-controlled": BLUE, "penalty": ORANGE, "none": GREY}
SMALLEST = 1e-17  # what is less is drawn there


def growth():
    """The largest growth of energy in each case, by the law of contact."""
    with (TABLES / "summary.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["energy grows by"]]
    cases = list(dict.fromkeys(row["case"] for row in rows))[::-1]
    figure = Figure(figsize=(7.5, 7.2))
    ax = figure.subplots()
    shift = {"energy-controlled": 0.0, "penalty": 0.22, "none": 0.0}
    for row in rows:
        passed, _, of = row["passes"].partition(" of ")
        law = row["enforcement"]
        ax.plot(
            max(float(row["energy grows by"]), SMALLEST),
            cases.index(row["case"]) + shift[law],
            "o" if passed == of else "X",
            color=COLOURS[law],
            ms=6 if passed == of else 9,
            clip_on=False,
        )
    ax.axvspan(0.01, 10, color=RED, alpha=0.15, lw=0)
    ax.set(xscale="log", xlim=(SMALLEST, 10), ylim=(-0.6, len(cases) - 0.4))
    ax.set_xticks(
        [SMALLEST, 1e-14, 1e-10, 1e-6, 1e-2, 1],
        ["none", *(f"$10^{{{e}}}$" for e in (-14, -10, -6, -2)), "1"],
    )
    ax.set_yticks(
        range(len(cases)),
        [case.replace("1000000", "10⁶").replace("100000", "10⁵") for case in cases],
    )
    ax.set_xlabel("largest growth of energy, over its scale")
    marks = [
        Line2D([], [], color=colour, marker="o", ls="", label=law.replace("none", "no contact"))
        for law, colour in COLOURS.items()
    ]
    marks.append(Line2D([], [], color="black", marker="X", ls="", ms=8, label="some runs fail"))
    figure.legend(handles=marks, loc="outside lower center", ncols=5, fontsize=9)
    return figure


def sweep():
    """Energy that the default law takes from two elastic plates, and the deepest point, over penalty and step."""
    with (TABLES / "plates.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    figure = Figure(figsize=(7.5, 3.4))
    lost, depth = figure.subplots(1, 2)
    steps = sorted({row["step"] for row in rows})
    marks = zip("osv^DX", (BLUE, ORANGE, GREEN, RED, VIOLET, "black"))
    for step, (mark, colour) in zip(steps, marks, strict=True):
        own = [row for row in rows if row["step"] == step]
        beta = [row["beta"] for row in own]
        style = {"marker": mark, "ms": 4, "lw": 1.2, "color": colour}
        lost.loglog(beta, [100 * row["energy lost"] for row in own], label=f"{step:g}", **style)
        depth.loglog(beta, [row["points / h"] for row in own], **style)
    lost.set(xlabel="penalty factor β", ylabel="energy lost, %")
    depth.set(xlabel="penalty factor β", ylabel="deepest Gauss point / h")
    figure.legend(
        *lost.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=6,
        title="step / stable step of the elements",
    )
    return figure


def fall(elements, impacts=12):
    """Height of the middle of a bar of length 10 and wave speed 30 that falls on a floor again and again, over time."""
    length, speed = 10.0, 30.0
    h = length / elements
    scene = ct.Scene(title="bouncing bar", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("soft", young=speed**2, poisson=0, density=1.0)
    box = {"origin": [0, 0, 5], "size": [h, h, length], "cells": [1, 1, elements]}
    scene.add_body("bar", material="soft", box=box)
    floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="bar.z_min", plane=floor, restitution=1.0)
    scene.add("gravity", acceleration=[0, 0, -10])
    scene.set_time(end=1 + impacts * 8 * length / speed, fraction=0.9)
    scene.set_output(every=6, fields=[])
    time, height = [], []

    def watch(run):
        time.append(run.state.time)
        height.append(run.state["bar"].positions[:, 2].mean() - 0.5 * length)
        return {}

    scene.run(progress=False, output=False, watch=watch)
    return np.array(time), np.array(height)


def bouncing():
    """The bouncing bar on two meshes, beside the one that keeps its energy."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    length, speed = 10.0, 30.0
    # A flight from the floor and back takes 2 s, the contact 2 L / c; the first fall 1 s.
    contact, period = 2 * length / speed, 8 * length / speed
    t = np.linspace(0, 1 + 12 * period, 3000)
    since = np.mod(t - 1, period) - contact
    flight = np.where(t < 1, t + 1, since)
    # During the contact the force is constant: a parabola, v L / 2c deep, with v = 10 m/s.
    part = since / contact + 1
    pressed = -2 * 10 * length / speed * part * (1 - part)
    exact = np.where((t >= 1) & (since < 0), pressed, 5 - 5 * (flight - 1) ** 2)
    ax.plot(t, exact, color="black", lw=1, label="without loss")
    for elements in (25, 100):
        ax.plot(*fall(elements), lw=1.3, label=f"{elements} elements")
    ax.set(xlabel="time [s]", ylabel="height of the bar [m]", xlim=(0, 33), ylim=(-2.4, 5.2))
    figure.legend(loc="outside lower center", ncols=3)
    return figure
