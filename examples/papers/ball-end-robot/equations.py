"""The equations of [BallEndRobot] by themselves, beside what robomill wrote: equations.py FOLDER

Reads cut-N.json and cuts/ of the folder, writes equations.json and forces.svg into it. The tool stands upright here, so that
F and T are one frame; angles count clockwise from +y (docs/frames.md)."""
import json
import math
import pathlib
import sys
import tomllib

folder = pathlib.Path(sys.argv[1])
LAYERS, TURNS = 400, 720


def polynomial(coefficients, angle):
    value = 0.0
    for coefficient in coefficients:
        value = value * angle + coefficient
    return value


def borders(radius, height, stepover):
    """Eq. 9 and 11: how far from +y the ring at that height is in the material, x > 0."""
    ring = math.sqrt(radius**2 - (radius - height) ** 2)
    lowest = radius - math.sqrt(radius**2 - stepover**2 / 4)
    if height < lowest:
        return math.pi
    return math.atan2(math.sqrt(2 * ring * stepover - stepover**2), ring - stepover)


def forces(cut, radial=None, chip=lambda feed, k, phi: feed * math.sin(k) * math.sin(phi), edge=lambda k, tan: math.sqrt(1 + math.sin(k) ** 4 * tan**2)):
    """Eq. 20 to 25: the force on the tool over a revolution, a sum over layers and teeth. [x, y, z] of each rotation.

    radial: another polynomial of Krc; chip, edge: another eq. 19 or 22. Kac and Kae are in the file with every sign turned, so that
    they act along + the axial column of eq. 24; that is the printed product."""
    tool, coefficients = cut["tool"], cut["coefficients"]
    radius, depth = tool["diameter_mm"] / 2, cut["cut"]["axial_depth_mm"]
    feed, stepover, teeth = cut["cut"]["feed_per_tooth_mm"], cut["cut"]["stepover_mm"], tool["teeth"]
    tan = math.tan(math.radians(tool["helix_deg"]))
    radial = radial or coefficients["radial_n_per_mm2"]
    last = math.acos((radius - depth) / radius)
    step = last / LAYERS
    out = [[0.0, 0.0, 0.0] for _ in range(TURNS)]
    for layer in range(LAYERS):
        k = (layer + 0.5) * step
        end = borders(radius, radius - radius * math.cos(k), stepover)
        width, length = radius * step, radius * step * edge(k, tan)
        kt, kr, ka = (polynomial(c, k) for c in (coefficients["tangential_n_per_mm2"], radial, coefficients["axial_n_per_mm2"]))
        et, er, ea = (coefficients[f"{name}_edge_n_per_mm"] * length for name in ("tangential", "radial", "axial"))
        lag = (1 - math.cos(k)) * tan
        for turn in range(TURNS):
            for tooth in range(teeth):
                phi = (2 * math.pi * (turn / TURNS + tooth / teeth) - lag) % (2 * math.pi)
                if phi >= end:
                    continue
                area = chip(feed, k, phi) * width
                ft, fr, fa = kt * area + et, kr * area + er, ka * area + ea
                s, c = math.sin(phi), math.cos(phi)
                force = out[turn]
                force[0] += -c * ft - math.sin(k) * s * fr + math.cos(k) * s * fa
                force[1] += s * ft - math.sin(k) * c * fr + math.cos(k) * c * fa
                force[2] += math.cos(k) * fr + math.sin(k) * fa
    return out


def summary(turns):
    mean = [sum(force[axis] for force in turns) / len(turns) for axis in range(3)]
    peak = [max((force[axis] for force in turns), key=abs) for axis in range(3)]
    return {"mean_n": mean, "peak_n": peak}


def geometry(cut, document):
    """Rings of the program against eq. 3, 4 and 11: the largest differences."""
    radius, stepover = cut["tool"]["diameter_mm"] / 2, cut["cut"]["stepover_mm"]
    ring, entry, exit_ = 0.0, 0.0, 0.0
    for at in document["engagement"]:
        height = at["height_mm"]
        ring = max(ring, abs(at["radius_mm"] - math.sqrt(radius**2 - (radius - height) ** 2)))
        arcs = at["arcs_deg"]
        if len(arcs) != 1:
            raise SystemExit(f"the ring at {height} mm has {len(arcs)} arcs")
        entry = max(entry, abs(arcs[0][0]))
        exit_ = max(exit_, abs(arcs[0][1] - math.degrees(borders(radius, height, stepover))))
    return {"ring_radius_mm": ring, "swept_line_deg": entry, "neighbour_deg": exit_,
            "h_min_mm": radius - math.sqrt(radius**2 - stepover**2 / 4), "h_mid_mm": radius - math.sqrt(radius**2 - stepover**2)}  # eq. 9, 10


def crosses_feed(document):
    """h_mid: where the exit passes 90°, that is y = 0, on a straight line between two rings."""
    rings = [(at["height_mm"], at["arcs_deg"][0][1]) for at in document["engagement"]]
    for (low, above), (high, below) in zip(rings, rings[1:]):
        if above >= 90 > below:
            return low + (high - low) * (above - 90) / (above - below)
    raise SystemExit("no ring's exit passes 90°")


def negative_from(coefficients):
    """The least angle at which a polynomial is negative, by halving."""
    steps = [i * math.radians(0.1) for i in range(901)]
    below = next(i for i, angle in enumerate(steps) if polynomial(coefficients, angle) < 0)
    low, high = steps[below - 1], steps[below]
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if polynomial(coefficients, middle) < 0 else (middle, high)
    return math.degrees(high)


def lowest_crossing(cut, document):
    """h_min from the program's chip area: the segment below it, and stepover times what is above."""
    radius, depth, stepover = cut["tool"]["diameter_mm"] / 2, document["axial_depth_left_mm"], cut["cut"]["stepover_mm"]
    half = math.asin(stepover / 2 / radius)
    segment = radius**2 * half - stepover / 2 * math.sqrt(radius**2 - stepover**2 / 4)
    return depth - (document["chip_area_mm2"] - segment) / stepover


def svg(courses):
    """Three panels side by side: force over rotation, rigid (thick) and with the deflection (thin)."""
    width, height, left, top = 300, 240, 46, 30
    colors = {"x": "#1f77b4", "y": "#d62728", "z": "#2ca02c"}
    parts = [f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {3 * width + 20} {height + 60}' font-family='sans-serif' font-size='11'>",
             f"<rect width='{3 * width + 20}' height='{height + 60}' fill='white'/>"]
    high = max(max(map(max, c.values())) for pair in courses for c in pair)
    low = min(min(map(min, c.values())) for pair in courses for c in pair)
    for index, (rigid, bent) in enumerate(courses):
        x0 = index * width + left
        across, down = width - left - 8, height - top
        def place(i, count, force):
            return f"{x0 + across * i / (count - 1):.1f},{top + down * (high - force) / (high - low):.1f}"
        parts.append(f"<rect x='{x0}' y='{top}' width='{across}' height='{down}' fill='none' stroke='#999'/>")
        parts.append(f"<text x='{x0}' y='{top - 10}'>cut {index + 1}</text>")
        for force in range(10 * math.ceil(low / 10), int(high) + 1, 20):
            y = top + down * (high - force) / (high - low)
            parts.append(f"<line x1='{x0}' x2='{x0 + across}' y1='{y:.1f}' y2='{y:.1f}' stroke='#eee'/>")
            if index == 0:
                parts.append(f"<text x='{x0 - 5}' y='{y + 4:.1f}' text-anchor='end'>{force}</text>")
        for degrees in (0, 90, 180, 270, 360):
            parts.append(f"<text x='{x0 + across * degrees / 360:.1f}' y='{height + 15}' text-anchor='middle'>{degrees}</text>")
        for course, stroke in ((rigid, 2), (bent, 0.8)):
            for axis, color in colors.items():
                points = " ".join(place(i, len(course[axis]), force) for i, force in enumerate(course[axis]))
                parts.append(f"<polyline points='{points}' fill='none' stroke='{color}' stroke-width='{stroke}'/>")
    parts.append(f"<text x='{left}' y='{height + 35}'>rotation (°); force on the tool (N)</text>")
    for index, (axis, color) in enumerate(colors.items()):
        parts.append(f"<text x='{left + 240 + 40 * index}' y='{height + 35}' fill='{color}'>F{axis}</text>")
    parts.append(f"<text x='{left + 370}' y='{height + 35}'>thick: the tool where it is programmed; thin: on the arm that deflects</text></svg>\n")
    return "\n".join(parts)


def main():
    out, courses = {"cuts": []}, []
    for number in (1, 2, 3):
        cut = tomllib.loads((folder / f"cuts/cut-{number}.toml").read_text())
        document = json.loads((folder / f"cut-{number}.json").read_text())
        turns = forces(cut)
        ours = summary(turns)
        of_cut = {"input": cut, **geometry(cut, document), "lowest_crossing_mm": lowest_crossing(cut, document),
                  "crosses_feed_mm": crosses_feed(document), "sum": ours,
                  "sum_less_program_n": max(abs(a - b) for a, b in zip(ours["mean_n"], document["rigid_mean_n"]))}
        printed = list(cut["coefficients"]["radial_n_per_mm2"])
        printed[1] = -15881
        of_cut["krc_as_printed"] = summary(forces(cut, radial=printed))
        of_cut["edge_length_as_printed"] = summary(forces(cut, edge=lambda k, tan: math.sqrt(1 + math.cos(k) ** 4 * tan**2)))
        of_cut["chip_as_printed"] = summary(forces(cut, chip=lambda feed, k, phi: feed * math.sin(k)))
        out["cuts"].append(of_cut)
        courses.append(({axis: [force[i] for force in turns] for i, axis in enumerate("xyz")},
                        {axis: document[f"f{axis}_n"] for axis in "xyz"}))
    leaning, upright = (json.loads((folder / f"{name}.json").read_text()) for name in ("leaning", "upright"))
    out["leaning"] = {"chip_area_less_upright_mm2": leaning["chip_area_mm2"] - upright["chip_area_mm2"]}
    rejected = (folder / "rejected.txt").read_text()
    out["krc"] = {"message": rejected.strip(), "negative_from_deg": negative_from(printed)}
    (folder / "equations.json").write_text(json.dumps(out, indent=1, ensure_ascii=False))
    (folder / "forces.svg").write_text(svg(courses))


main()
