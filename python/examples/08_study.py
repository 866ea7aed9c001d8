# %% [markdown]
# # A study with a process pool
# The limit over two parameters, each point in a process of its own: structs are pickled, the library's threads are one a process.

# %%
import concurrent.futures
import itertools
import multiprocessing

import numpy as np

import robomill
from robomill import cutting, modal, stability, units


def limit_mm(point):
    """The lowest limit from 4,000 to 12,000 rpm of a tool with so many teeth and so much damping."""
    problem, teeth, damping_ratio = point
    tool = problem.milling.tool.replace(teeth=teeth)
    dynamics = modal.modes_from_mass(x=[modal.MassMode(frequency_hz=650.0, damping_ratio=damping_ratio, modal_mass_kg=0.6)], y=[])
    options = stability.LobesOptions(spindle_speed_rad_per_s=[4000 * units.rpm, 12000 * units.rpm], axial_depth_m=[0, 20 * units.mm], grid=[41, 20],
                                     output="limits")
    lobes = stability.compute_lobes(problem=problem.replace(milling=problem.milling.replace(tool=tool), dynamics=dynamics), options=options)
    return min(one.axial_depth_m for one in lobes.limit if one.status.name == "found") / units.mm


# %%
if __name__ == "__main__":
    milling = cutting.Milling(tool=cutting.FlatEndMill(teeth=4, diameter_m=16 * units.mm),
                              immersion=cutting.immersion(direction="slot", radial_depth_m=0.0, diameter_m=16 * units.mm),
                              coefficients=cutting.ForceCoefficients(tangential_n_per_m2=700 * units.n_per_mm2, radial_n_per_m2=250 * units.n_per_mm2))
    problem = stability.LobesProblem(milling=milling)
    teeth, damping = (2, 3, 4), np.linspace(0.01, 0.05, 5)
    points = [(problem, *point) for point in itertools.product(teeth, damping)]
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        limits = np.array(list(pool.map(limit_mm, points))).reshape(len(teeth), len(damping))
    print(np.round(limits, 3))
    assert (np.diff(limits, axis=1) > 0).all()  # more damping, more depth
