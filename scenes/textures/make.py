#!/usr/bin/env python3
"""Makes the pictures in this folder, which scenes/textures.xml and tests/scenes/relief.xml use: as PNG files, with what
Python brings."""

import math
import pathlib
import random
import struct
import zlib

HERE = pathlib.Path(__file__).resolve().parent


def write_png(name, width, height, channels, bits, value):
    """value(x, y) is a sequence of numbers in [0, 1], one a channel."""
    largest, rows = (1 << bits) - 1, b""
    for y in range(height):
        rows += b"\0"
        for x in range(width):
            for number in value(x, y):
                rows += round(min(max(number, 0), 1) * largest).to_bytes(bits // 8, "big")

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    colour = {1: 0, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    (HERE / name).write_bytes(data)


def wood(x, y):
    """Rings of a plank, which tile when mirrored."""
    ring = 0.5 + 0.5 * math.sin(0.9 * y + 2.5 * math.sin(0.13 * x) + 0.6 * math.sin(0.7 * x))
    return 0.45 + 0.3 * ring, 0.28 + 0.22 * ring, 0.14 + 0.12 * ring


def tiles(x, y):
    """Four colours between dark joints."""
    if x % 16 == 0 or y % 16 == 0:
        return 0.1, 0.1, 0.12
    colours = ((0.8, 0.3, 0.25), (0.25, 0.5, 0.8), (0.9, 0.85, 0.6), (0.3, 0.65, 0.35))
    return colours[(x // 16 + 2 * (y // 16)) % 4]


def ripples(x, y):
    """Heights that tile over 32 x 32."""
    turn = 2 * math.pi / 32
    return (0.5 + 0.25 * math.sin(2 * turn * x + 1.5 * math.sin(turn * y)) + 0.2 * math.cos(3 * turn * y + turn * x),)


def dents(x, y):
    """Normals of round dents, steep enough for many to be seen from behind."""
    across, down = x % 8 - 3.5, y % 8 - 3.5
    distance = math.hypot(across, down)
    steep = 0.9 * distance / 3.5 if distance < 3.5 else 0
    normal = (steep * across / distance, -steep * down / distance, math.sqrt(1 - steep**2)) if steep > 0 else (0, 0, 1)
    return tuple(0.5 + 0.5 * n for n in normal)


def main():
    noise = random.Random(1)
    write_png("wood.png", 48, 32, 3, 8, wood)
    write_png("tiles.png", 32, 32, 4, 8, lambda x, y: (*tiles(x, y), 0.5))  # the alpha is to be left out
    write_png("hues.png", 12, 8, 3, 16, lambda x, y: (x / 11, y / 7, 1 - (x + y) / 18))
    write_png("brushed.png", 24, 6, 1, 8, lambda x, y: (0.12 + 0.35 * noise.random(),))
    write_png("spots.png", 24, 24, 1, 16, lambda x, y: (1 if (x % 12 - 6) ** 2 + (y % 12 - 6) ** 2 < 16 else 0.1,))
    write_png("ripples.png", 32, 32, 1, 16, ripples)
    write_png("dents.png", 16, 16, 3, 16, dents)


if __name__ == "__main__":
    main()
