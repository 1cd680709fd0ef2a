#!/usr/bin/env python3
"""scripts/draw_diagrams.py, from anywhere: draws the diagrams of docs/how_it_works as SVG into docs/images."""

import math
import pathlib

INK, MUTED, MATERIAL, OVERLAP = "#1f2933", "#7b8794", "#dbe7f3", "#b5cde6"
GOOD, BAD, ACCENT = "#1f7a4d", "#b42318", "#b7791f"


class Drawing:
    """An SVG under construction; y points up, and one unit is a pixel."""

    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def point(self, p):
        return f"{p[0]:.1f},{self.height - p[1]:.1f}"

    def polygon(self, points, fill=MATERIAL, stroke=MUTED, width=1.0, opacity=1.0):
        self.parts.append(f'<polygon points="{" ".join(map(self.point, points))}" fill="{fill}" fill-opacity="{opacity}" '
                          f'stroke="{stroke}" stroke-width="{width}" stroke-linejoin="round"/>')

    def line(self, points, stroke=INK, width=1.5, dash="", arrow=False):
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        extra += f' marker-end="url(#{"arrow" + stroke[1:]})"' if arrow else ""
        self.parts.append(f'<polyline points="{" ".join(map(self.point, points))}" fill="none" stroke="{stroke}" '
                          f'stroke-width="{width}" stroke-linecap="round" stroke-linejoin="round"{extra}/>')

    def dot(self, p, fill=INK, radius=3.5):
        x, y = self.point(p).split(",")
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}"/>')

    def text(self, p, words, fill=INK, size=14, anchor="start", style=""):
        x, y = self.point(p).split(",")
        words = words.replace("&", "&amp;").replace("<", "&lt;")
        self.parts.append(f'<text x="{x}" y="{y}" font-family="Helvetica, Arial, sans-serif" font-size="{size}" '
                          f'fill="{fill}" text-anchor="{anchor}" {style}>{words}</text>')

    def caption(self, x, lines, y=52):
        for i, words in enumerate(lines):
            self.text((x, y - 17 * i), words, size=12.5, anchor="middle")

    def save(self, path):
        markers = "".join(
            f'<marker id="arrow{c[1:]}" viewBox="0 0 10 10" refX="8.5" refY="5" markerWidth="7" markerHeight="7" '
            f'orient="auto-start-reverse"><path d="M0,0.8 L10,5 L0,9.2 z" fill="{c}"/></marker>'
            for c in (INK, MUTED, GOOD, BAD, ACCENT))
        body = "\n".join(self.parts)
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                        f'viewBox="0 0 {self.width} {self.height}">\n<defs>{markers}</defs>\n'
                        f'<rect width="{self.width}" height="{self.height}" rx="8" fill="white"/>\n{body}\n</svg>\n')


def along(a, b, t):
    return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))


def strip(points_low, points_high):
    """Triangles of a strip between two rows of points."""
    triangles = []
    for (a, b), (c, d) in zip(zip(points_low, points_low[1:]), zip(points_high, points_high[1:])):
        triangles += [(a, b, d), (a, d, c)]
    return triangles


def draw_paths(folder):
    """Left: a valid path and a blocked one. Right: what two rays say of the elements around a vertex."""
    d = Drawing(900, 400)
    # A bar, and the same strip's end that has come back into it from above.
    bar = strip([(40 + 44 * i, 110) for i in range(9)], [(40 + 44 * i, 230) for i in range(9)])
    tip = strip([(262, 160), (262, 205), (262, 250), (262, 300)], [(330, 160), (330, 205), (330, 250), (330, 300)])
    for triangle in bar:
        d.polygon(triangle, MATERIAL)
    for triangle in tip:
        d.polygon(triangle, OVERLAP, opacity=0.75)
    d.line([(40, 110), (392, 110)], INK, 2.2)
    d.line([(40, 230), (392, 230)], INK, 2.2)
    d.line([(262, 300), (262, 160), (330, 160), (330, 300)], INK, 2.2)
    d.text((296, 316), "another part of the same mesh", MUTED, 12, "middle")
    p, s, blocked = (232, 168), (232, 110), (262, 168)
    d.line([p, s], GOOD, 2.6, arrow=True)
    d.line([p, blocked], BAD, 2.6, dash="5 4", arrow=True)
    d.dot(p)
    d.text((218, 174), "p", size=16, anchor="end")
    d.text((226, 92), "s", GOOD, 16)
    d.text((252, 180), "s'", BAD, 16, "end")
    d.caption(216, ["s' is nearer, but in the mesh no path leads to it:",
                    "the segment stays in the bar and passes through s'.",
                    "The segment to s crosses common faces, one by one."])
    # Elements around a vertex, once and twice.
    for centre, turns, title in (((560, 235), 1, "covered once"), ((770, 235), 2, "covered twice")):
        count = 6 * turns
        for i in range(count):
            angles = [2 * math.pi * turns * k / count + 0.3 for k in (i, i + 1)]
            radii = [62 + (26 * turns - 26) * k / count * 1.6 for k in (i, i + 1)]
            rim = [(centre[0] + r * math.cos(a), centre[1] + r * math.sin(a)) for r, a in zip(radii, angles)]
            d.polygon([centre] + rim, MATERIAL if i < 6 else OVERLAP, opacity=0.9 if i < 6 else 0.45)
        ray = (0.35, 0.937)
        for sign, name in ((1, "d"), (-1, "-d")):
            end = (centre[0] + sign * 118 * ray[0], centre[1] + sign * 118 * ray[1])
            d.line([centre, end], ACCENT, 2.2, arrow=True)
            d.text((end[0] + (8 if sign > 0 else 14), end[1]), name, ACCENT, 16)
        d.dot(centre)
        d.text((centre[0] - 84, centre[1] + 124), title, MUTED, 13)
    d.caption(665, ["Each vertex sends out two rays.",
                    "One element holds each: nothing is covered twice there.",
                    "More than one: only the definition decides."])
    d.line([(440, 30), (440, 370)], "#e4e7eb", 1)
    d.save(folder / "boundary_path.svg")


def ellipse(centre, a, b, start=0.0, stop=2 * math.pi, count=72):
    return [(centre[0] + a * math.cos(start + (stop - start) * i / count),
             centre[1] + b * math.sin(start + (stop - start) * i / count)) for i in range(count + 1)]


def draw_cones(folder):
    """Two discs, slit and joined crosswise: conditions 1 and 2 hold, and the sheets meet."""
    d = Drawing(900, 380)
    low, high = (160, 130), (160, 270)
    d.polygon(ellipse(low, 130, 42), MATERIAL, INK, 2)
    d.polygon(ellipse(high, 82, 26), OVERLAP, INK, 2, 0.9)
    for centre in (low, high):
        d.line([along(centre, (centre[0] - 45, centre[1]), 1), (centre[0] + 45, centre[1])], BAD, 3)
    d.text((298, 126), "larger disc", MUTED, 13)
    d.text((250, 268), "smaller disc", MUTED, 13)
    d.text((160, 252), "slit", BAD, 13, "middle")
    d.caption(180, ["Cut both discs along a slit ..."], 40)
    # A cut across the slit: the sheets change places.
    x, y = 455, 200
    d.line([(x - 75, y - 45), (x - 14, y - 45), (x + 14, y + 45), (x + 55, y + 45)], GOOD, 3)
    d.line([(x - 55, y + 45), (x - 14, y + 45), (x + 14, y - 45), (x + 75, y - 45)], ACCENT, 3)
    d.dot((x, y), BAD, 5)
    d.text((x + 12, y - 4), "they meet", BAD, 13)
    d.text((x, y + 70), "seen across the slit", MUTED, 13, "middle")
    d.caption(455, ["... and join the sides", "crosswise."], 58)
    centre = (730, 205)
    d.polygon(ellipse(centre, 118, 118), MATERIAL, INK, 2)
    d.polygon(ellipse(centre, 74, 74), OVERLAP, INK, 2)
    d.line([(centre[0] - 45, centre[1]), (centre[0] + 45, centre[1])], BAD, 3)
    for radius, angle in ((118, 0.6), (74, 2.3)):
        a = [(centre[0] + radius * math.cos(angle + k), centre[1] + radius * math.sin(angle + k)) for k in (0, 0.06)]
        d.line(a, INK, 2, arrow=True)
    d.text((730, 232), "N = 2", INK, 15, "middle")
    d.text((730, 296), "N = 1", INK, 15, "middle")
    d.caption(730, ["From above, both contours are simple and disjoint,", "but nested: inside the smaller one N = 2."], 58)
    d.save(folder / "self_collision_cones.svg")


def draw_contact(folder):
    """p goes along an edge, q follows in the other part, until q comes to a boundary face."""
    d = Drawing(900, 340)
    body = strip([(60 + 60 * i, 90) for i in range(7)], [(60 + 60 * i, 170) for i in range(7)])
    other = strip([(180, 130), (250, 130), (320, 130)], [(180, 290), (250, 290), (320, 290)])
    for triangle in body:
        d.polygon(triangle, MATERIAL)
    for triangle in other:
        d.polygon(triangle, OVERLAP, opacity=0.7)
    d.line([(60, 170), (420, 170)], INK, 2.2)
    d.line([(180, 290), (180, 130), (320, 130), (320, 290)], INK, 2.2)
    d.line([(320, 130), (320, 290)], BAD, 3.2)
    d.dot((212, 170), GOOD, 5)
    d.line([(216, 170), (306, 170)], GOOD, 3, arrow=True)
    d.dot((320, 170), BAD, 5)
    d.text((212, 184), "p, q", GOOD, 15, "middle")
    d.text((330, 210), "face g", BAD, 15)
    d.text((424, 166), "edge", MUTED, 13)
    d.caption(245, ["p moves along a boundary edge. q is a point of another part",
                    "and moves along in the same place. The boundary face g",
                    "stops q: so g meets the edge."])
    d.line([(490, 30), (490, 310)], "#e4e7eb", 1)
    x = 520
    for i, (head, tail) in enumerate((
            ("1  q comes to a boundary face", "that face meets the segment"),
            ("2  q comes to an inverted or flat element", "that element meets the segment"),
            ("3  q comes to where p is", "elements around a vertex overlap"),
            ("4  p comes to the end of the segment", "the end is doubled, too"))):
        d.text((x, 285 - 62 * i), head, INK, 15)
        d.text((x + 18, 264 - 62 * i), tail, MUTED, 14)
    d.text((x, 34), "Each end marks a face; the search starts there.", INK, 12.5)
    d.save(folder / "contact.svg")


def draw_search(folder):
    """Left: two nodes and the pairs of their children that meet. Right: what decides a pair of triangles."""
    d = Drawing(900, 360)
    # Two strands of a surface, each in four boxes; the strands pass through one another.
    strands = [[(40 + 6 * i, 215 + 42 * math.cos(0.11 * i + phase)) for i in range(41)] for phase in (0.0, math.pi)]
    boxes = []
    for strand, colour in zip(strands, (GOOD, ACCENT)):
        own = []
        for k in range(4):
            part = strand[10 * k:10 * k + 11]
            low = (min(x for x, _ in part), min(y for _, y in part) - 5)
            high = (max(x for x, _ in part), max(y for _, y in part) + 5)
            own.append((low, high))
            d.polygon([low, (high[0], low[1]), high, (low[0], high[1])], "none", colour, 1.2)
        boxes.append(own)
        d.line(strand, colour, 2.6)
    d.text((46, 290), "A", GOOD, 16)
    d.text((46, 130), "B", ACCENT, 16)
    # The mask: one bit for each child of A with each child of B.
    def meet(a, b):
        return all(a[0][i] <= b[1][i] and b[0][i] <= a[1][i] for i in (0, 1))
    left, top, cell = 352, 268, 26
    for i, a in enumerate(boxes[0]):
        for k, b in enumerate(boxes[1]):
            x, y = left + cell * k, top - cell * i
            square = [(x, y), (x + cell, y), (x + cell, y - cell), (x, y - cell)]
            d.polygon(square, BAD if meet(a, b) else "white", MUTED, 1, 0.75 if meet(a, b) else 1)
        d.text((left - 14, top - cell * i - 18), str(i + 1), GOOD, 12, "middle")
    for k in range(4):
        d.text((left + cell * k + cell / 2, top + 8), str(k + 1), ACCENT, 12, "middle")
    d.caption(245, ["The children of two nodes are compared all at once:",
                    "a bit for each pair of boxes that meet (here four",
                    "children a node, in the code eight)."])
    d.line([(490, 30), (490, 330)], "#e4e7eb", 1)
    # Three triangles against the plane of another, seen along it.
    for x, name, verdict, colour, triangle in (
            (570, "beside the plane", "apart", GOOD, [(-34, 20), (28, 34), (4, 78)]),
            (695, "through both planes", "they cross", BAD, [(-22, -46), (30, 18), (-4, 58)]),
            (820, "within the rounding", "exact test", ACCENT, [(-34, 2), (30, 38), (2, 72)])):
        base = 205
        d.line([(x - 56, base), (x + 56, base)], "#e4e7eb", 11)
        d.line([(x - 56, base), (x + 56, base)], INK, 2.4)
        d.polygon([(x + px, base + py) for px, py in triangle], MATERIAL, colour, 2, 0.85)
        d.text((x, 132), name, INK, 13, "middle")
        d.text((x, 113), verdict, colour, 15, "middle")
    d.caption(695, ["A pair of triangles, one seen from its edge, with the bound",
                    "of all rounding (grey). Single precision decides most pairs;",
                    "exact arithmetic decides the rest."])
    d.save(folder / "self_collision.svg")


if __name__ == "__main__":
    images = pathlib.Path(__file__).resolve().parent.parent / "docs" / "images"
    draw_paths(images)
    draw_cones(images)
    draw_contact(images)
    draw_search(images)
