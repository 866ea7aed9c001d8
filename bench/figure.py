"""A small plot as SVG, for the scripts beside it: axes, curves, legend."""
import math

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]  # [Okabe2008]
WIDTH, HEIGHT = 760, 460
LEFT, TOP, BOTTOM = 70, 20, 55


class Axis:
    """From low to high, linear or logarithmic (of powers of ten)."""

    def __init__(self, low, high, title, log=False, ticks=None):
        self.low, self.high, self.title, self.log = low, high, title, log
        self.ticks = ticks  # (value, text) each

    def share(self, value):
        if self.log:
            value = min(max(value, self.low), self.high)
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


class Figure:
    def __init__(self, x, y, right=230):
        self.x_axis, self.y_axis, self.right = x, y, WIDTH - right
        self.legend_y = TOP + 14
        self.out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
                    'font-size="13">', f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
        floor = HEIGHT - BOTTOM
        for value, text in x.ticks:
            self.out.append(f'<line x1="{self.x(value):.1f}" y1="{TOP}" x2="{self.x(value):.1f}" y2="{floor}" stroke="#ddd"/>')
            self.out.append(f'<text x="{self.x(value):.1f}" y="{floor + 18}" text-anchor="middle">{text}</text>')
        for value, text in y.ticks:
            self.out.append(f'<line x1="{LEFT}" y1="{self.y(value):.1f}" x2="{self.right}" y2="{self.y(value):.1f}" stroke="#ddd"/>')
            self.out.append(f'<text x="{LEFT - 8}" y="{self.y(value) + 4:.1f}" text-anchor="end">{text}</text>')
        self.out.append(f'<text x="{(LEFT + self.right) / 2}" y="{HEIGHT - 12}" text-anchor="middle">{x.title}</text>')
        middle = (TOP + floor) / 2
        self.out.append(f'<text x="16" y="{middle}" text-anchor="middle" transform="rotate(-90 16 {middle})">{y.title}</text>')

    def x(self, value):
        return LEFT + self.x_axis.share(value) * (self.right - LEFT)

    def y(self, value):
        return HEIGHT - BOTTOM - self.y_axis.share(value) * (HEIGHT - TOP - BOTTOM)

    def curve(self, points, colour, dashed=False):
        line = " ".join(f"{self.x(x):.1f},{self.y(y):.1f}" for x, y in points)
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>')

    def mark(self, x, y, colour, hollow=False):
        fill = "white" if hollow else colour
        self.out.append(f'<circle cx="{self.x(x):.1f}" cy="{self.y(y):.1f}" r="5" fill="{fill}" stroke="{colour}" stroke-width="2"/>')

    def limit(self, x, text):
        """A line across the plot, named above it."""
        at = self.x(x)
        self.out.append(f'<line x1="{at:.1f}" y1="{TOP - 3}" x2="{at:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#333" stroke-dasharray="2 3"/>')
        self.out.append(f'<text x="{at:.1f}" y="{TOP - 6}" text-anchor="middle" font-size="11">{text}</text>')

    def legend(self, text, colour=None, dashed=False, hollow=None, indented=False):
        """A line of the legend; without a colour only its text, with `hollow` the sign of a mark."""
        at, left = self.legend_y, self.right + 16
        if colour and hollow is not None:
            self.out.append(f'<circle cx="{left + 12}" cy="{at - 4}" r="5" fill="{"white" if hollow else colour}" '
                            f'stroke="{colour}" stroke-width="2"/>')
        elif colour:
            dash = ' stroke-dasharray="5 4"' if dashed else ""
            self.out.append(f'<line x1="{left}" y1="{at - 4}" x2="{left + 24}" y2="{at - 4}" stroke="{colour}" stroke-width="2"{dash}/>')
        self.out.append(f'<text x="{left + (32 if colour or indented else 0)}" y="{at}">{text}</text>')
        self.legend_y += 20

    def gap(self):
        self.legend_y += 12

    def print(self):
        print("\n".join(self.out + ["</svg>"]))
