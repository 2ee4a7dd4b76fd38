"""Predict the front of Fig. 4 before you run it: the sum of its waves, for other steps, meshes and integrators."""

import libcontact as ct

print("                          overshoot  late, elements  late / d")
for name, elements, courant, integrator in (
    ("the paper", 100, 0.125, "central_difference"),
    ("half the step", 100, 0.0625, "central_difference"),
    ("half the elements", 50, 0.125, "central_difference"),
    ("twice the elements", 200, 0.125, "central_difference"),
    ("eight times the step", 100, 1.0, "central_difference"),
    ("Tchamwa, small step", 100, 0.125, "tchamwa_wielgosz"),
    ("Tchamwa, large step", 100, 0.875, "tchamwa_wielgosz"),
    ("Chung, small step", 100, 0.125, "chung_lee"),
    ("Chung, large step", 100, 0.875, "chung_lee"),
):
    travel = 0.56 * elements  # in elements
    front = ct.dispersion_front(travel, courant=courant, integrator=integrator)
    late = travel - front.half_height
    print(f"{name:25} {front.overshoot:9.1%} {late:15.2f} {late / elements:9.4f}")
