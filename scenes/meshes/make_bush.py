#!/usr/bin/env python3
"""Writes bush.obj: a crown of 490 flat leaves, each open and apart from all others, over a closed trunk of ten sides:
1,000 triangles, 3.2 m high. make_bush.py > bush.obj"""
import math
import random

random.seed(11)
LEAVES, SIDES, RADIUS, MIDDLE, HALF = 490, 5, 1.3, 1.9, 0.14
lines = ["# A bush of 490 leaves, by make_bush.py", "o bush", "usemtl bark"]
for y, r in ((0, 0.12), (1.9, 0.05)):
    lines += [
        f"v {r * math.sin(2 * math.pi * i / SIDES):.3f} {y} {r * math.cos(2 * math.pi * i / SIDES):.3f}"
        for i in range(SIDES)
    ]
lines += ["v 0 0 0", "v 0 1.9 0"]
for i in range(1, SIDES + 1):
    j = i % SIDES + 1
    lines += [f"f {i} {j} {j + SIDES} {i + SIDES}", f"f {2 * SIDES + 1} {j} {i}", f"f {2 * SIDES + 2} {i + SIDES} {j + SIDES}"]
lines.append("usemtl leaf")


def unit():
    """A direction, all alike."""
    y, a = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
    return math.sqrt(1 - y * y) * math.sin(a), y, math.sqrt(1 - y * y) * math.cos(a)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


for _ in range(LEAVES):
    out, normal = unit(), unit()
    r = RADIUS * random.random() ** (1 / 3)
    side = cross(normal, unit())
    length = math.sqrt(sum(s * s for s in side))
    side = [HALF * s / length for s in side]
    along = cross(normal, side)
    center = [r * out[0], MIDDLE + r * out[1], r * out[2]]
    for s, a in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        lines.append("v " + " ".join(f"{c + s * x + a * y:.3f}" for c, x, y in zip(center, side, along)))
    lines.append("f -4 -3 -2 -1")
print("\n".join(lines))
