"""Impact of two plates: the exact solution, and the table of ``make accuracy``."""

from __future__ import annotations

import re

import campaign
import defaults
import drawings
import face as free_face
import numpy as np
from libcontact.planning import answer

import libcontact as ct

from .shared import ROOT, Numbers, measurement


@measurement
def exact() -> Numbers:
    """Speeds and angle of the waves for ν = 0.3, where the fronts cross the line of Fig. 5, and one point by Cagniard's
    path: x = 0.4, z = 0.8, t = 0.56."""
    c2, c_r = ct.exact.speeds(0.3)
    x, t = 0.4, 0.56
    point = free_face.path_point(x, 0.2, t, 1.0)
    own = free_face.face(x, 0.2, t).sum(axis=0)[1]
    start, touch = ct.exact.fronts(t)["head"][0]
    late = free_face.face(x, 0.1, 1.0)[:, 1]
    return {
        "head_angle": np.degrees(np.arcsin(c2)),
        "c_r": c_r,
        "c_r_over_c2": c_r / c2,
        "fig5_p": 1 - np.sqrt(t * t - x * x),
        "fig5_head": start[1] + (touch[1] - start[1]) * (x - start[0]) / (touch[0] - start[0]),
        "p_re": point.real,
        "p_im": point.imag,
        "s_y": own,
        "sigma_z": ct.exact.plates(x, 0.8, t).stress.sigma_z,
        "late_p": late[0],
        "late_s": late[1],
    }


@measurement
def accuracy() -> Numbers:
    """From the table of the campaign: errors and cost of the paper's setting, of the same mesh at 0.98 and of the best
    buy; what a contact error is; powers of 1/h."""
    rows = drawings.load()
    paper = rows[campaign.case("reference", 100, campaign.PAPER).name]
    best = rows[campaign.case("reference", 100, campaign.BEST).name]
    buy = drawings.best_buy(rows)[1]
    found = {f"paper_{name}": paper[name] for name in ("l1_fig4", "l1_fig5", "l1_fig5_at_056")}
    for name, row in (("step", best), ("buy", buy)):
        found |= {f"{name}_fig4": row["l1_fig4"], f"{name}_fig5": row["l1_fig5"]}
        found[f"{name}_cheaper"] = 1 / row["times_paper"]
        found[f"{name}_fewer"] = paper["updates"] / row["updates"]
    found |= {"buy_cells": buy["cells"], "buy_overshoot": buy["overshoot"]}
    rho = re.search(r"integrator_parameter=([\d.]+)", buy["setting"])
    found["buy_rho"] = float(rho[1]) if rho else 0.9  # the default
    sharp = rows[campaign.case("reference", 100, campaign.SHARP).name]
    front = ("width", "overshoot", "variation_fig5", "variation_along", "variation_fig5_at_056")
    found |= {f"sharp_{name}": sharp[name] for name in front} | {"sharp_updates": sharp["cost"]}
    found |= {f"step_{name}": best[name] for name in ("overshoot", "variation_along")}
    own = rows[campaign.case("reference", 100, campaign.METHODS["default at 0.98, filtered"]).name]
    found |= {f"filtered_{key[3:]}": own[key] for key in ("l1_fig4", "l1_fig5")}
    found |= {f"filtered_{key}": own[key] for key in ("overshoot", "width")}
    found["filtered_updates"] = own["cost"]
    table = defaults.table.read(defaults.table.BOOK / "accuracy_defaults.csv")
    for name in defaults.SCENES:
        own = [row for row in table if row["scene"] == name]
        found |= {
            f"default_{name}": defaults.distances(own)[""],
            f"beaten_{name}": defaults.beaten(own),
        }
        if name == "bounces":
            found["bounces_loss"] = own[0]["error"]
    for name, keys in (("paper", campaign.PAPER), ("best", campaign.BEST)):
        cases = drawings.meshes(rows, "reference", keys)
        for column in ("updates", "l1_fig4"):
            x, y = drawings.values(rows, cases, "cells", column)
            found[f"{name}_{column}_power"] = abs(np.polyfit(np.log(x), np.log(y), 1)[0])
        found[f"{name}_contact"] = rows[campaign.case("contact", 100, keys).name]["contact_l1"]
    for name, keys in (("hex8", campaign.BEST), ("hex20", campaign.METHODS["hex20"])):
        for share, change in (("", {}), ("_lost", {"contact.restitution": 0.0})):
            row = rows[campaign.case("contact", campaign.LAW_CELLS, keys | change).name]
            found[f"{name}{share}_fig4"] = row["l1_fig4"]
    return found


@measurement
def planned_plates() -> Numbers:
    """The planner's error of the paper's setting: L1 on Fig. 4's line over the plateau."""
    scene = ct.Scene.load(ROOT / "tutorials" / "scenes" / "plates.toml")
    problem = scene._built(None)
    plates = answer.plates(problem)
    assert plates is not None
    return {"paper": plates.error(problem, scene.run(progress=False, output=False))}
