import numpy as np

import libcontact as ct

scene = ct.Scene.load("tutorials/scenes/plates.toml")
print(scene.explain())  # what will be computed, what will not, and why
run = scene.run(progress=True)
s, stress = run.line("stress_xx", (-2.5, 0.0125, 0), (2.5, 0.0125, 0))
plateau = np.median(stress[abs(s - 2.5) < 1])  # within 1 mm of the contact
print(plateau)
