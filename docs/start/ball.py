import numpy as np

import libcontact as ct

radius, depth, young, nu = 4.0, 0.1, 1000.0, 0.3
print(f"Hertz: {2 / np.pi * young / (1 - nu**2) * np.sqrt(depth / radius):.1f} MPa")
for cells in (10, 20, 40):
    for beta in (2, None):
        law = f"beta = {beta}" if beta else "default penalty"
        data = ct.Scene.load(ct.example("hertz")).data
        data["body"][0]["box"]["cells"] = [cells] * 3
        if beta is None:
            del data["obstacle"][0]["beta"]
        run = ct.Scene(data).run(progress=False, output=False)
        pressure = run.pressure["obstacle"][0]["pressure"].max()
        print(f"{cells} cells, {law}: {pressure:.1f} MPa")
