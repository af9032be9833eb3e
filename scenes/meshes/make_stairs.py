#!/usr/bin/env python3
"""Writes stairs.obj: a closed staircase, 6 m wide, ten steps of 0.5 m height and 0.8 m depth, that rises toward -z.
make_stairs.py > stairs.obj"""
STEPS, RISE, RUN, HALF = 10, 0.5, 0.8, 3.0
profile = [(STEPS * RUN / 2, 0.0)]  # z, y: up the steps, then down the back
for i in range(STEPS):
    z, y = profile[-1]
    profile += [(z, y + RISE), (z - RUN, y + RISE)]
profile.append((profile[-1][0], 0.0))
lines = ["# A closed staircase, by make_stairs.py", "o stairs"]
normals, faces = [], []
for x in (-HALF, HALF):
    lines += [f"v {x:g} {y:g} {z:.10g}" for z, y in profile]
count = len(profile)


def face(corners, normal):
    normals.append(normal)
    faces.append("f " + " ".join(f"{c + 1}//{len(normals)}" for c in corners))


for i in range(count):
    (z0, y0), (z1, y1) = profile[i], profile[(i + 1) % count]
    length = abs(z1 - z0) + abs(y1 - y0)
    face((i, i + count, (i + 1) % count + count, (i + 1) % count), (0, (z0 - z1) / length, (y1 - y0) / length))
for side, x in ((0, -1), (count, 1)):
    for i in range(STEPS):  # a column under each step
        riser, top = 2 * i + 1, 2 * i + 2
        z0, z1 = profile[riser][0], profile[top][0]
        lines += [f"v {x * HALF:g} 0 {z0:.10g}", f"v {x * HALF:g} 0 {z1:.10g}"]
        a = 2 * count + (STEPS if side else 0) * 2 + 2 * i
        corners = [a, a + 1, side + top, side + riser]
        face(corners if x < 0 else corners[::-1], (x, 0, 0))
lines += [f"vn {x:g} {y:g} {z:g}" for x, y, z in normals] + faces
print("\n".join(lines))
