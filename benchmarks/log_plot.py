# SPDX-License-Identifier: BSD-3-Clause
"""A log-log plot as SVG text, legible on light and dark pages; no library needed."""
import math

WIDTH, HEIGHT = 940, 460
PANEL_WIDTH, PANEL_HEIGHT = 385, 310
TOP, LEFT, PANEL_STEP = 92, 70, 455
LEGEND_STEP = 176

LIGHT = {"page": "#ffffff", "text": "#24292f", "faint": "#57606a", "grid": "#d8dee4",
         "frame": "#8c959f", "series": ("#0550ae", "#8250df", "#bc4c00", "#bf3989", "#1a7f37")}
DARK = {"page": "#0d1117", "text": "#e6edf3", "faint": "#9198a1", "grid": "#262c36",
        "frame": "#656c76", "series": ("#79b8ff", "#c8a2ff", "#ffa657", "#f778ba", "#56d364")}
FORMS = """text { font: 12px system-ui, -apple-system, "Segoe UI", Helvetica, Arial, sans-serif; }
.title { font-size: 15px; font-weight: 600; } .power { font-size: 9px; }
.line { stroke-width: 2; fill: none; } .main { stroke-width: 3.2; }
.frame { fill: none; }"""


def colours(scheme):
    rules = [f".{name} {{ fill: {scheme[name]}; }}" for name in ("page", "text", "faint")]
    rules += [f".{name} {{ stroke: {scheme[name]}; }}" for name in ("grid", "frame")]
    for k, colour in enumerate(scheme["series"]):
        rules += [f".line.s{k} {{ stroke: {colour}; }}", f".fill.s{k} {{ fill: {colour}; }}"]
    return "\n".join(rules)


def style():
    dark = f"@media (prefers-color-scheme: dark) {{\n{colours(DARK)}\n}}"
    return f"{FORMS}\n{colours(LIGHT)}\n{dark}"


def decades(values):
    """The least and the greatest power of ten around the values."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


class Panel:
    """One pair of axes; points are (n, seconds)."""

    def __init__(self, number, x_decades, y_decades):
        self.left = LEFT + number * PANEL_STEP
        self.x_decades, self.y_decades = x_decades, y_decades

    def x(self, value):
        low, high = self.x_decades
        return self.left + PANEL_WIDTH * (math.log10(value) - low) / (high - low)

    def y(self, value):
        low, high = self.y_decades
        return TOP + PANEL_HEIGHT * (high - math.log10(value)) / (high - low)

    def power(self, exponent, x, y, anchor):
        return (f'<text class="faint" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">10'
                f'<tspan class="power" dy="-5">{exponent}</tspan></text>')

    def axes(self, title):
        right, bottom = self.left + PANEL_WIDTH, TOP + PANEL_HEIGHT
        parts = [f'<text class="text title" x="{self.left}" y="{TOP - 16}">{title}</text>']
        for exponent in range(self.x_decades[0], self.x_decades[1] + 1):
            x = self.x(10.0 ** exponent)
            parts += [f'<path class="grid" d="M{x:.1f} {TOP}V{bottom}"/>',
                      self.power(exponent, x, bottom + 20, "middle")]
        for exponent in range(self.y_decades[0], self.y_decades[1] + 1):
            y = self.y(10.0 ** exponent)
            parts += [f'<path class="grid" d="M{self.left} {y:.1f}H{right}"/>',
                      self.power(exponent, self.left - 8, y + 5, "end")]
        parts += [f'<rect class="frame" x="{self.left}" y="{TOP}" width="{PANEL_WIDTH}" '
                  f'height="{PANEL_HEIGHT}"/>',
                  f'<text class="faint" x="{(self.left + right) / 2}" y="{bottom + 42}" '
                  'text-anchor="middle">points N</text>']
        return parts

    def curve(self, number, points):
        path = "L".join(f"{self.x(n):.1f} {self.y(seconds):.1f}" for n, seconds in points)
        weight = " main" if number == 0 else ""
        return ([f'<path class="line{weight} s{number}" d="M{path}"/>'] +
                [f'<circle class="fill s{number}" cx="{self.x(n):.1f}" cy="{self.y(seconds):.1f}" '
                 'r="3.4"/>' for n, seconds in points])


def legend(names):
    parts, x = [], LEFT
    for k, name in enumerate(names):
        weight = " main" if k == 0 else ""
        parts += [f'<path class="line{weight} s{k}" d="M{x} 24h24"/>',
                  f'<circle class="fill s{k}" cx="{x + 12}" cy="24" r="3.4"/>',
                  f'<text class="text" x="{x + 31}" y="28">{name}</text>']
        x += LEGEND_STEP
    return parts


def plot(panels):
    """SVG text. `panels`: (title, [(name, [(n, seconds), ...]), ...]), the same names in each."""
    points = [point for _, series in panels for _, curve in series for point in curve]
    if not points:
        return None
    x_decades, y_decades = decades([p[0] for p in points]), decades([p[1] for p in points])
    parts = [f'<rect class="page" width="{WIDTH}" height="{HEIGHT}" rx="8"/>',
             f'<text class="faint" transform="translate(20 {TOP + PANEL_HEIGHT / 2}) rotate(-90)" '
             'text-anchor="middle">seconds to the first realization</text>']
    parts += legend([name for name, _ in panels[0][1]])
    for number, (title, series) in enumerate(panels):
        panel = Panel(number, x_decades, y_decades)
        parts += panel.axes(title)
        for k, (_, curve) in enumerate(series):
            parts += panel.curve(k, curve) if curve else []
    body = "\n".join(parts)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}" role="img" '
            'aria-label="Seconds to the first realization against the number of points">\n'
            f'<style>\n{style()}\n</style>\n{body}\n</svg>\n')
