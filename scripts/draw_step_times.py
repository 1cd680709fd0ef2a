#!/usr/bin/env python3
"""scripts/draw_step_times.py RESULT.json...: draws docs/images/step_times.svg, the time of each part of a step with and
without culling, from what `selvage_bench simulation --json` wrote."""

import json
import pathlib
import sys

from draw_diagrams import INK, MUTED, Drawing

# Parts of a step, as in the summary of a run, and their colours. What is left goes to projection and velocities.
PARTS = (("material", "material", "#4e79a7"), ("ccd", "CCD", "#59a14f"), ("dcd", "DCD and refits", "#edc948"),
         ("paths", "shortest paths", "#d1495b"), ("rest", "projection, rest", "#bab0ac"))
LEFT, WIDTH, LONGEST, BAR, GAP, GROUP = 150, 400, 520, 11, 2, 34  # pixels; WIDTH is that of a step with culling


def parts_of(run):
    """Milliseconds a step of each part."""
    step = 1e3 * run["seconds"]["steps"] / run["steps"]
    shares = dict(run["shares"])
    shares["rest"] = max(0.0, 1 - sum(shares.values()))
    return {name: step * shares[name] for name, _, _ in PARTS}


def draw_bar(drawing, y, parts, unit):
    x = LEFT
    for name, _, colour in PARTS:
        end = min(x + parts[name] * unit, LEFT + LONGEST)
        drawing.polygon([(x, y), (end, y), (end, y + BAR), (x, y + BAR)], colour, "white", 0.5)
        x = end
    total = sum(parts.values())
    beyond = total * unit > LONGEST
    paths = 100 * parts["paths"] / total
    words = f"{total:.3g} ms" + (f", {paths:.0f}% paths" if paths >= 0.5 else "") + (", cut off" if beyond else "")
    drawing.text((x + 6, y + 2), words, MUTED, 11)


def draw(runs, path):
    names = [run["scene"] for run in runs if run["culling"]]
    height = 84 + GROUP * len(names)
    drawing = Drawing(LEFT + LONGEST + 130, height)
    x = LEFT
    for _, label, colour in PARTS:
        drawing.polygon([(x, height - 30), (x + 12, height - 30), (x + 12, height - 18), (x, height - 18)], colour, "white")
        drawing.text((x + 17, height - 28), label, INK, 12)
        x += 34 + 6.6 * len(label)
    drawing.text((LEFT, height - 52), "a step of each scene: upper bar with culling, lower bar without", MUTED, 12)
    for i, name in enumerate(names):
        y = height - 84 - GROUP * i
        bars = {run["culling"]: parts_of(run) for run in runs if run["scene"] == name}
        unit = WIDTH / sum(bars[True].values())
        drawing.text((LEFT - 10, y - BAR + 2), name, INK, 13, "end")
        draw_bar(drawing, y, bars[True], unit)
        draw_bar(drawing, y - BAR - GAP, bars[False], unit)
    drawing.save(path)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    draw([run for name in sys.argv[1:] for run in json.loads(pathlib.Path(name).read_text())["runs"]],
         pathlib.Path(__file__).resolve().parent.parent / "docs" / "images" / "step_times.svg")
