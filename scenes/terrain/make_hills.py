#!/usr/bin/env python3
"""Writes hills.png: 257 x 257, 16 bits, grey, rolling hills. Usage: make_hills.py hills.png

Seven octaves of gradient noise (Perlin 2002, doi:10.1145/566654.566636) on an integer hash, the higher ones
damped where the ground is low (Musgrave's heterogeneous terrain), so that valleys are smooth and ridges are not.
Only the standard library; the same file on every machine up to zlib's version (the heights are the same).
"""
import math
import struct
import sys
import zlib

SIDE = 257
SEED = 20011


def mix(x):
    """splitmix64's finaliser."""
    x = (x + 0x9E3779B97F4A7C15) & 0xFFFFFFFFFFFFFFFF
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & 0xFFFFFFFFFFFFFFFF
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & 0xFFFFFFFFFFFFFFFF
    return x ^ (x >> 31)


def gradient(i, j, octave):
    angle = mix(mix(mix(SEED + octave) ^ i) ^ (j << 20)) / 2**64 * 2 * math.pi
    return math.cos(angle), math.sin(angle)


def noise(x, y, octave):
    """Gradient noise, about -0.7..0.7."""
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    corners = []
    for dj in (0, 1):
        for di in (0, 1):
            gx, gy = gradient(i + di, j + dj, octave)
            corners.append(gx * (u - di) + gy * (v - dj))
    u = u * u * u * (u * (6 * u - 15) + 10)
    v = v * v * v * (v * (6 * v - 15) + 10)
    low = corners[0] + u * (corners[1] - corners[0])
    high = corners[2] + u * (corners[3] - corners[2])
    return low + v * (high - low)


def height(x, y):
    """x, y in 0..1."""
    total = 0.55 + noise(4.3 * x, 4.3 * y, 0)
    frequency, amplitude = 8.9, 0.6
    for octave in range(1, 7):
        total += amplitude * max(total, 0.0) * noise(frequency * x, frequency * y, octave)
        frequency *= 2.03
        amplitude *= 0.58
    return total


def chunk(kind, data):
    body = kind + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))


def main():
    rows = [[height(i / (SIDE - 1), j / (SIDE - 1)) for i in range(SIDE)] for j in range(SIDE)]
    low, high = min(map(min, rows)), max(map(max, rows))
    raw = b""
    for row in rows:
        values = [round((h - low) / (high - low) * 65535) for h in row]
        raw += b"\0" + struct.pack(f">{SIDE}H", *values)
    header = struct.pack(">IIBBBBB", SIDE, SIDE, 16, 0, 0, 0, 0)
    with open(sys.argv[1], "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


main()
