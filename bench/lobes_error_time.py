#!/usr/bin/env python3
"""Draws error against time of every lobes method as an SVG:
build/bench/lobes_error_time | bench/lobes_error_time.py > robomill/stability/error_time.svg"""
import csv
import math
import sys

WIDTH, HEIGHT = 760, 460
LEFT, RIGHT, TOP, BOTTOM = 70, 230, 20, 55
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]  # [Okabe2008]


def main():
    rows = list(csv.DictReader(sys.stdin))
    methods = {}
    for row in rows:
        time_us = float(row["microseconds_per_limit"])
        error = max(float(row["median_error"]), 1e-12)
        methods.setdefault(row["method"], []).append((time_us, error))
    times = [t for points in methods.values() for t, _ in points]
    errors = [e for points in methods.values() for _, e in points]
    x_low, x_high = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
    y_low, y_high = math.floor(math.log10(min(errors))), math.ceil(math.log10(max(errors)))

    def x(value):
        return LEFT + (math.log10(value) - x_low) / (x_high - x_low) * (WIDTH - LEFT - RIGHT)

    def y(value):
        return HEIGHT - BOTTOM - (math.log10(value) - y_low) / (y_high - y_low) * (HEIGHT - TOP - BOTTOM)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for power in range(x_low, x_high + 1):
        at = x(10.0 ** power)
        out.append(f'<line x1="{at:.1f}" y1="{TOP}" x2="{at:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(f'<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">1e{power}</text>')
    for power in range(y_low, y_high + 1):
        at = y(10.0 ** power)
        out.append(f'<line x1="{LEFT}" y1="{at:.1f}" x2="{WIDTH - RIGHT}" y2="{at:.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">1e{power}</text>')
    for i, (method, points) in enumerate(methods.items()):
        colour = COLOURS[i % len(COLOURS)]
        line = " ".join(f"{x(t):.1f},{y(e):.1f}" for t, e in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x(t):.1f}" cy="{y(e):.1f}" r="4" fill="{colour}"/>' for t, e in points]
        at = TOP + 14 + 22 * i
        out.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{at - 4}" r="4" fill="{colour}"/>')
        out.append(f'<text x="{WIDTH - RIGHT + 30}" y="{at}">{method}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 12}" text-anchor="middle">'
               'processor time of one limit (µs)</text>')
    out.append(f'<text x="16" y="{(TOP + HEIGHT - BOTTOM) / 2}" text-anchor="middle" '
               f'transform="rotate(-90 16 {(TOP + HEIGHT - BOTTOM) / 2})">median error of the limit (share)</text>')
    out.append("</svg>")
    print("\n".join(out))


main()
