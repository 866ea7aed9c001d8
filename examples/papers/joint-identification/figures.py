#!/usr/bin/env python3
"""Numbers, checks of the equations and plots from what `run` computed. Standard library only.

figures.py FOLDER: reads FOLDER/*.json, writes FOLDER/numbers.json, convergence.csv and the plots *.svg."""
import cmath
import csv
import json
import math
import pathlib
import statistics
import sys
import tomllib

OUT = pathlib.Path(sys.argv[1])
HERE = pathlib.Path(__file__).parent
PAIR = tomllib.loads((HERE / "pair.toml").read_text())  # as printed
TOOL, HOLDER = PAIR["tool"][0], PAIR["holder"]["segments"][0]
D, E = TOOL["diameter_mm"] * 1e-3, TOOL["youngs_modulus_gpa"] * 1e9
RHO, ETA = TOOL["density_kg_per_m3"], TOOL["loss_factor"]
L1, L2 = HOLDER["length_mm"] * 1e-3, TOOL["length_mm"] * 1e-3
AREA, INERTIA = math.pi * D**2 / 4, math.pi * D**4 / 64
JOINT = tuple(PAIR["joint"][f"{way}_{what}"] for way, what in (
    ("translational", "stiffness_n_per_m"), ("translational", "damping_n_s_per_m"),
    ("rotational", "stiffness_n_m_per_rad"), ("rotational", "damping_n_m_s_per_rad")))
MASS = tomllib.loads((HERE / "bar-mass.toml").read_text())["accelerometer"]["mass_kg"]
SENSOR = tomllib.loads((HERE / "bar-sensor.toml").read_text())["accelerometer"]["mass_kg"]
SOFT = tomllib.loads((HERE / "soft.toml").read_text())["joint"]["rotational_stiffness_n_m_per_rad"]
GENERATIONS = range(PAIR["search"]["generations"] + 1)
SEEDS = range(1, 21)


def read(name):
    return json.loads((OUT / name).read_text())


def curve(name, frf="xx"):
    document = read(name)
    values = document["receptance_m_per_n"][frf]
    return document["frequency_hz"], [complex(a, b) for a, b in zip(values["re"], values["im"])]


def peaks(name, of=abs):
    """Maxima between lines, by a parabola through the logarithms of three."""
    f, h = curve(name)
    y = [math.log(of(v)) for v in h]
    out = []
    for i in range(1, len(f) - 1):
        if y[i - 1] < y[i] >= y[i + 1] and y[i] > min(y[max(0, i - 300):i + 300]) + 1.0:
            bend = y[i - 1] - 2 * y[i] + y[i + 1]
            shift = 0.5 * (y[i - 1] - y[i + 1]) / bend
            out.append((f[i] + shift * (f[i + 1] - f[i]), math.exp(y[i] - 0.25 * (y[i - 1] - y[i + 1]) * shift)))
    return out


def published(f, printed=False):
    """Eqs. 7 to 9 and table 1 at a frequency: as they are right, or as they are printed."""
    w = 2 * math.pi * f
    ei = E * INERTIA * (1 + 1j * ETA)
    lam = (w**2 * RHO * AREA / ei) ** 0.25
    a, b = lam * L1, lam * L2
    cos, sin, cosh, sinh = cmath.cos, cmath.sin, cmath.cosh, cmath.sinh
    b1, b2, b5 = cos(a) * sinh(a) - sin(a) * cosh(a), sin(a) * sinh(a), cos(a) * sinh(a) + sin(a) * cosh(a)
    c8 = ei * (cos(a) * cosh(a) + 1)
    c1, c2, c5 = cos(b) * sinh(b) - sin(b) * cosh(b), sin(b) * sinh(b), cos(b) * sinh(b) + sin(b) * cosh(b)
    c3 = sin(a) - sinh(a) if printed else sin(b) - sinh(b)
    c4 = cos(b) * cosh(b) if printed else cos(b) - cosh(b)
    c6, c7 = sin(b) + sinh(b), ei * (cos(b) * cosh(b) - 1)
    return {
        "h2b2b": -b1 / (lam**3 * c8), "n2b2b": (b1 if printed else b2) / (lam**2 * c8), "p2b2b": b5 / (lam * c8),
        "h2a2a": -c1 / (lam**3 * c7), "n2a2a": -c2 / (lam**2 * c7), "p2a2a": c5 / (lam * c7),
        "h12a": c3 / (lam**3 * c7), "n12a": c4 / (lam**2 * c7), "l12a": -c4 / (lam**2 * c7), "p12a": c6 / (lam * c7),
        "h11": -c1 / (lam**3 * c7), "n11": c2 / (lam**2 * c7), "p11": c5 / (lam * c7)}


def inverse(m):
    (a, b), (c, d) = m
    det = a * d - b * c
    return [[d / det, -b / det], [-c / det, a / det]]


def times(m, n):
    return [[sum(m[i][k] * n[k][j] for k in range(len(n))) for j in range(len(n[0]))] for i in range(len(m))]


def coupled(f, r, joint):
    """H11 of eq. 6."""
    w = 2 * math.pi * f
    flexibility = [1 / (joint[0] + 1j * w * joint[1]), 1 / (joint[2] + 1j * w * joint[3])]
    total = [[r["h2a2a"] + r["h2b2b"] + flexibility[0], r["n2a2a"] + r["n2b2b"]],
             [r["n2a2a"] + r["n2b2b"], r["p2a2a"] + r["p2b2b"] + flexibility[1]]]
    row = [[r["h12a"], r["l12a"]]]
    return r["h11"] - times(times(row, inverse(total)), [[r["h12a"]], [r["l12a"]]])[0][0]


def equations():
    """The largest relative difference of each closed form from what robomill computes, from 100 Hz on: below, those of
    the free beam cancel."""
    f, pair = curve("pair.json")
    holder, tool = read("holder.json"), read("tool.json")

    def of(document, name, i):
        values = document["receptance_m_per_n"][name]
        return complex(values["re"][i], values["im"][i])

    worst = {}

    def keep(name, value, ours):
        worst[name] = max(worst.get(name, 0.0), abs(value - ours) / abs(ours))

    for i in range(99, len(f), 7):
        for printed in (False, True):
            r = published(f[i], printed)
            mark = " as printed" if printed else ""
            keep("h2b2b" + mark, r["h2b2b"], of(holder, "xx", i))
            keep("n2b2b" + mark, abs(r["n2b2b"]), abs(of(holder, "ry:x", i)))
            keep("p2b2b" + mark, r["p2b2b"], of(holder, "ry:my", i))
            for end in ("h11", "h2a2a"):
                keep(end + mark, r[end], of(tool, "xx", i))
            for end in ("n11", "n2a2a"):
                keep(end + mark, abs(r[end]), abs(of(tool, "ry:x", i)))
            for end in ("p11", "p2a2a"):
                keep(end + mark, r[end], of(tool, "ry:my", i))
            keep("eq6" + mark, coupled(f[i], r, JOINT), pair[i])
    return worst


def misfit(a, b):
    return math.sqrt(sum((abs(x) - abs(y)) ** 2 for x, y in zip(a, b)))


def searches(kind):
    runs = [read(f"{kind}-{seed}.json") for seed in SEEDS]
    status = [run["convergence"]["status"] for run in runs]
    return {"objective": [run["objective"] for run in runs],
            "median_objective": statistics.median(run["objective"] for run in runs),
            "least_objective": min(run["objective"] for run in runs),
            "greatest_objective": max(run["objective"] for run in runs),
            "status": status, "stalled": status.count("stalled"), "converged": status.count("converged"),
            "not_converged": status.count("not converged"),
            "translational_stiffness_n_per_m": [run["joint"]["translational_stiffness_n_per_m"] for run in runs],
            "rotational_stiffness_n_m_per_rad": [run["joint"]["rotational_stiffness_n_m_per_rad"] for run in runs]}


def fit(name):
    found = read(name)
    return {"relative_error": found["relative_error"], "status": found["convergence"]["status"], **found["joint"]}


def mass_at_tip(frequency_hz):
    """The mass with which the undamped clamped bar has this frequency: the root of
    1 + cos x cosh x + μ x (cos x sinh x - sin x cosh x)."""
    length = L1 + L2
    x = length * ((2 * math.pi * frequency_hz) ** 2 * RHO * AREA / (E * INERTIA)) ** 0.25
    share = (1 + math.cos(x) * math.cosh(x)) / (x * (math.sin(x) * math.cosh(x) - math.cos(x) * math.sinh(x)))
    return share * RHO * AREA * length


def inputs():
    """What robomill was given."""
    bar = tomllib.loads((HERE / "bar.toml").read_text())["tool"][0]
    return {"unknowns": len(PAIR["joint"]), "search": PAIR["search"],
            "inputs": {"diameter_mm": TOOL["diameter_mm"], "free_length_mm": TOOL["length_mm"],
                       "clamped_length_mm": HOLDER["length_mm"], "bar_length_mm": bar["length_mm"],
                       "density_kg_per_m3": TOOL["density_kg_per_m3"],
                       "youngs_modulus_gpa": TOOL["youngs_modulus_gpa"],
                       "poissons_ratio": TOOL["poissons_ratio"], "loss_factor": TOOL["loss_factor"]}}


COLOURS = ("#1f6feb", "#d1242f", "#1a7f37", "#9a6700", "#8250df")


def plot(path, curves, x_label, y_label, x_range, log_y=True):
    """curves: (name, x, y)."""
    width, height, left, top, right, bottom = 640, 320, 70, 16, 190, 44
    shown = [(n, [(a, b) for a, b in zip(x, y) if x_range[0] <= a <= x_range[1]]) for n, x, y in curves]
    y_of = math.log10 if log_y else float
    values = [y_of(b) for _, points in shown for _, b in points]
    low, high = min(values), max(values)
    low, high = low - 0.04 * (high - low), high + 0.04 * (high - low)
    place_x = lambda v: left + (v - x_range[0]) / (x_range[1] - x_range[0]) * (width - left - right)
    place_y = lambda v: top + (high - v) / (high - low) * (height - top - bottom)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
             f'font-size="12"><rect width="{width}" height="{height}" fill="white"/>'
             f'<rect x="{left}" y="{top}" width="{width - left - right}" height="{height - top - bottom}" fill="none" '
             'stroke="#888"/>']
    for k in range(6):
        v = x_range[0] + k / 5 * (x_range[1] - x_range[0])
        parts.append(f'<text x="{place_x(v):.1f}" y="{height - bottom + 16}" text-anchor="middle">{v:g}</text>')
        y = low + k / 5 * (high - low)
        text = f"{10**y:.2g}" if log_y else f"{y:.3g}"
        parts.append(f'<text x="{left - 6}" y="{place_y(y) + 4:.1f}" text-anchor="end">{text}</text>')
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">{x_label}</text>')
    parts.append(f'<text x="14" y="{(top + height - bottom) / 2}" text-anchor="middle" '
                 f'transform="rotate(-90 14 {(top + height - bottom) / 2})">{y_label}</text>')
    for k, (name, points) in enumerate(shown):
        step = max(1, len(points) // 400)
        line = " ".join(f"{place_x(a):.1f},{place_y(y_of(b)):.1f}" for a, b in points[::step])
        colour = COLOURS[k % len(COLOURS)]
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
        parts.append(f'<text x="{width - right + 10}" y="{top + 14 + 18 * k}" fill="{colour}">{name}</text>')
    (OUT / path).write_text("\n".join(parts) + "\n</svg>\n")


def main():
    numbers = inputs()
    numbers["mass_for_measured_kg"] = mass_at_tip(275.0)
    numbers["holder_mode_hz"] = peaks("holder.json")[0][0]
    numbers["tool_mode_hz"] = peaks("tool.json", lambda v: abs(v.imag))[0][0]
    for name in ("bar", "pair", "bar-sensor", "bar-mass", "soft"):
        found = peaks(f"{name}.json")
        numbers[name] = {"first_hz": found[0][0], "first_m_per_n": found[0][1], "second_hz": found[1][0],
                         "second_m_per_n": found[1][1], "static_m_per_n": abs(curve(f"{name}.json")[1][0])}
    bar, pair = curve("bar.json")[1], curve("pair.json")[1]
    numbers["objective_of_printed_joint"] = misfit(bar, pair)
    numbers["error_of_printed_joint"] = (math.sqrt(sum(abs(a - b) ** 2 for a, b in zip(bar, pair))) /
                                         math.sqrt(sum(abs(a) ** 2 for a in bar)))
    for kind in ("ga", "wide", "adaptive"):
        numbers[kind] = searches(kind)
    numbers["hybrid"] = {"objective": read("hybrid.json")["objective"], "visible": read("hybrid.json")["visible_up_to"]}
    numbers["fits"] = {name: fit(f"{name}.json") for name in
                       ("joint-1000", "joint-mass-1000", "bed-1000", "joint-5000", "joint-mass-5000", "bed-5000")}
    numbers["equations"] = equations()
    right = ("h2b2b", "n2b2b", "p2b2b", "h11", "n11", "p11", "h2a2a", "n2a2a", "p2a2a", "eq6")
    for name in right:
        if not numbers["equations"][name] < 1e-6:
            raise SystemExit(f"{name}: {numbers['equations'][name]:.2g} from the closed form")
    for name in ("n2b2b", "eq6"):
        if not numbers["equations"][name + " as printed"] > 0.01:
            raise SystemExit(f"{name}: as printed it agrees")
    (OUT / "numbers.json").write_text(json.dumps(numbers, indent=1) + "\n")
    bests = {seed: read(f"ga-{seed}.json")["convergence"] for seed in SEEDS}
    with open(OUT / "convergence.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["generation"] + [f"seed_{seed}_objective_m_per_n" for seed in SEEDS])
        for generation in GENERATIONS:
            rows.writerow([generation] + [b["start"] if generation == 0 else b["best"][generation - 1]
                                          for b in bests.values()])
    plot("convergence.svg",
         [(f"seed {s}: {bests[s]['status']}", GENERATIONS, [bests[s]["start"]] + bests[s]["best"]) for s in range(1, 6)],
         "generation", "best objective (m/N)", (0, GENERATIONS[-1]), log_y=True)
    shown = (("clamped bar", "bar"), ("printed joint", "pair"), (f"{1e3 * SENSOR:g} g on the tip", "bar-sensor"),
             (f"{1e3 * MASS:g} g on the tip", "bar-mass"), (f"{SOFT:g} N m/rad, no mass", "soft"))
    for path, span in (("first-mode.svg", (200, 400)), ("second-mode.svg", (1500, 2000))):
        plot(path, [(n, curve(f"{k}.json")[0], [abs(v) for v in curve(f"{k}.json")[1]]) for n, k in shown],
             "frequency (Hz)", "|H11| (m/N)", span)


main()
