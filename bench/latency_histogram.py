#!/usr/bin/env python3
"""Draws histograms of what a hop costs as an SVG, of the cases named, from what monitor_latency prints:
bench/latency_histogram.py transform < latency.txt > robomill/signal/latency.svg"""
import csv
import sys

from figure import COLOURS, Axis, Figure

CLOCKS = {"processor": "processor time", "wall": "wall clock"}


def main():
    lines = sys.stdin.read().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("what,clock,"))
    bins, labels = {}, {}
    for row in csv.DictReader(lines[start:]):
        bins.setdefault((row["what"], row["clock"]), []).append(
            (float(row["from_us"]), float(row["to_us"]), int(row["hops"])))
    for line in lines[2:start]:  # the table: mean, median, 99 %, 99.9 %
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 5:
            labels[cells[0], cells[1]] = f"{float(cells[3]) / 1e3:.2f}, 99.9 % {float(cells[5]) / 1e3:.2f} ms"
    decades = [(10.0 ** (p + 3), f"{10.0 ** p:g}") for p in range(-2, 3)]
    shares = [(10.0 ** -p, f"{10.0 ** (2 - p):g}") for p in range(6)]
    figure = Figure(Axis(10, 1e5, "a hop of 256 samples (ms)", log=True, ticks=decades),
                    Axis(1e-5, 1, "share of the hops, 20 bins a decade (%)", log=True, ticks=shares), right=275)
    for what, colour in zip(sys.argv[1:], COLOURS):
        figure.legend(f"{what}, {sum(hops for _, _, hops in bins[what, 'wall']):,} hops")
        for clock, name in CLOCKS.items():
            of = bins[what, clock]
            total = sum(hops for _, _, hops in of)
            steps = [(of[0][0], 1e-5)]
            for low, high, hops in of:
                share = max(1e-5, hops / total)
                steps += [(low, share), (high, share)]
            steps.append((of[-1][1], 1e-5))
            figure.curve(steps, colour, dashed=clock == "wall")
            figure.legend(name, colour, dashed=clock == "wall")
            figure.legend(f"median {labels[what, clock]}", indented=True)
        figure.gap()
    figure.limit(300, "0.3 ms")
    figure.limit(1000, "1 ms")
    figure.legend("Goals: a hop below 0.3 ms,")
    figure.legend("99.9 % of them below 1 ms.")
    figure.print()


main()
