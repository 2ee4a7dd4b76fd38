"""Colours and marks of the pictures. The colours are those of book.mplstyle, in its order."""

import numpy as np

BLUE, ORANGE, GREEN, RED = "#3b8bd4", "#e8762b", "#3fa34d", "#d64550"
VIOLET, GREY = "#9b6fd0", "#8a8a8a"
DARK = "#101010"  # over an image with pale colours: black, and light on a dark page, is for lines beside it


def line(ax, a, b, **style):
    """A straight line between two points of a plane."""
    ax.plot(*np.array([a, b], float).T, **style)


def arrow(ax, start, along, name, colour="black", off=(0.0, 0.0)):
    """An arrow with its name at the tip."""
    start, along = np.asarray(start, float), np.asarray(along, float)
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", start + along, start, arrowprops=style)
    ax.text(*(start + 1.16 * along + off), name, color=colour, ha="center", va="center")


def bare(ax, x, y):
    """Axes without frame, of equal scales."""
    ax.set(xlim=x, ylim=y, aspect="equal")
    ax.set_axis_off()


def axes_in_space(figure, place=111, elev=18, azim=-64):
    """Axes in space without box and ticks."""
    ax = figure.add_subplot(place, projection="3d", computed_zorder=False)
    ax.view_init(elev=elev, azim=azim)
    ax.set_axis_off()
    return ax


def arrow_in_space(ax, start, along, name, colour):
    """An arrow with its name beyond the tip, in space."""
    ax.quiver(*start, *along, color=colour, arrow_length_ratio=0.12, lw=1.8)
    beyond = start + (1 + 0.2 / np.linalg.norm(along)) * along
    ax.text(*beyond, name, color=colour, ha="center", va="center")
