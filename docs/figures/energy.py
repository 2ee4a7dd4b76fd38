"""Pictures of the chapter on energy."""

from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, ORANGE, RED
from shared.scenes import bar_on_wall, done


def ledger():
    """Energies of a bar that hits a wall."""
    run = done(bar_on_wall().set_time(end=2.6, fraction=0.9))
    figure = Figure(figsize=(7.5, 3.2))
    ax, off = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    start = run.energy["total"][0]
    for name, colour in (("kinetic", BLUE), ("strain", ORANGE), ("reserve", GREEN)):
        ax.plot(run.time, run.energy[name] / start, color=colour, label=name)
    ax.plot(run.time, run.energy["total"] / start, color="black", label="total")
    ax.legend(ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    ax.set(ylabel="energy / start", ylim=(-0.05, 1.1))
    off.plot(run.time, 1e3 * (run.energy["total"] / start - 1), color="black")
    off.set(xlabel="time c t / L", ylabel="change, ‰")
    return figure


def drift():
    """Total energy of a bar that hits a wall: two laws of contact, two steps."""
    figure = Figure(figsize=(7.5, 2.8))
    for ax, fraction in zip(figure.subplots(1, 2, sharey=True), (0.3, 0.95)):
        for law, colour, name in (
            ("penalty", RED, "explicit penalty"),
            ("energy_controlled", BLUE, "energy-controlled"),
        ):
            scene = bar_on_wall(enforcement=law, beta=1.0).set_time(end=2.6, fraction=fraction)
            run = done(scene)
            ax.plot(
                run.time,
                100 * (run.energy["total"] / run.energy["total"][0] - 1),
                color=colour,
                label=name,
            )
        ax.set(title=f"{fraction} of the stable step", xlabel="time c t / L")
    figure.axes[0].set_ylabel("change of the total, %")
    figure.axes[0].legend(fontsize=9)
    return figure
