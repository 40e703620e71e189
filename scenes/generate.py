#!/usr/bin/env python3
"""Writes the meshes of the project's own scenes into meshes/, with the standard library only.

The meshes are kept in the repository, so that a fresh clone renders without this script. It gives the same bytes on
every run: change a shape here, run it, and render the references again (tests/references/make.py).

    python3 scenes/generate.py [--output FOLDER]

All lengths are in scene units; the comment at the top of each scene file says how its meshes are placed.
"""

import argparse
import math
import pathlib
import struct
import zlib


def normalized(vector):
    length = math.sqrt(sum(component * component for component in vector))
    return tuple(component / length for component in vector)


def torus(major_radius, minor_radius, major_segments, minor_segments):
    """A torus around the y axis, centred at the origin, with the exact normals of the torus at its vertices.

    Returns positions, normals and triangles whose winding gives the outward normal."""
    positions, normals, triangles = [], [], []
    for i in range(major_segments):
        around = 2 * math.pi * i / major_segments
        for j in range(minor_segments):
            across = 2 * math.pi * j / minor_segments
            normal = (math.cos(across) * math.cos(around), math.sin(across), math.cos(across) * math.sin(around))
            positions.append(
                (
                    major_radius * math.cos(around) + minor_radius * normal[0],
                    minor_radius * normal[1],
                    major_radius * math.sin(around) + minor_radius * normal[2],
                )
            )
            normals.append(normal)
    for i in range(major_segments):
        for j in range(minor_segments):
            i_next, j_next = (i + 1) % major_segments, (j + 1) % minor_segments
            a = i * minor_segments + j
            b = i_next * minor_segments + j
            c = i_next * minor_segments + j_next
            d = i * minor_segments + j_next
            triangles += [(a, c, b), (a, d, c)]
    return positions, normals, triangles


def block(half_x, half_y, half_z):
    """A box centred at the origin. Each face has its own four vertices, so the normals at them are exact."""
    half = (half_x, half_y, half_z)
    positions, normals, triangles = [], [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            first = len(positions)
            normal = [0.0, 0.0, 0.0]
            normal[axis] = float(sign)
            for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[u], corner[v] = sign * half[axis], su * half[u], sv * half[v]
                positions.append(tuple(corner))
                normals.append(tuple(normal))
            order = (0, 1, 2, 3) if sign > 0 else (0, 3, 2, 1)
            a, b, c, d = (first + k for k in order)
            triangles += [(a, b, c), (a, c, d)]
    return positions, normals, triangles


def perforated_plane(holes_per_side, hole_ratio):
    """A square from -1 to 1 in x and z at y = 0, facing +y, with holes_per_side^2 octagonal holes.

    hole_ratio: the distance from a hole's centre to its corners, over half the pitch of the holes (below 1)."""
    count = holes_per_side
    half_pitch = 1.0 / count
    index_of, positions, triangles = {}, [], []

    def vertex(x, z):
        key = (round(x * 1e6), round(z * 1e6))
        if key not in index_of:
            index_of[key] = len(positions)
            positions.append((x, 0.0, z))
        return index_of[key]

    # The border of a cell and the border of its hole both have eight points, at the same eight directions.
    directions = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
    for row in range(count):
        for column in range(count):
            x = -1 + (2 * column + 1) * half_pitch
            z = -1 + (2 * row + 1) * half_pitch
            outer, inner = [], []
            for k, (dx, dz) in enumerate(directions):
                angle = k * math.pi / 4
                outer.append(vertex(x + dx * half_pitch, z + dz * half_pitch))
                radius = hole_ratio * half_pitch
                inner.append(vertex(x + radius * math.cos(angle), z + radius * math.sin(angle)))
            for k in range(8):
                n = (k + 1) % 8
                triangles += [(outer[k], inner[k], inner[n]), (outer[k], inner[n], outer[n])]
    return positions, None, triangles


def icosphere(subdivisions):
    """A unit sphere of triangles, made by splitting an icosahedron; its normals are its positions."""
    golden = (1 + math.sqrt(5)) / 2
    positions = []
    for a in (-1, 1):
        for b in (-golden, golden):
            positions += [(0, a, b), (a, b, 0), (b, 0, a)]
    positions = [normalized(p) for p in positions]
    edge = min(math.dist(positions[0], p) for p in positions[1:]) * 1.01

    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                p, q, r = positions[i], positions[j], positions[k]
                if max(math.dist(p, q), math.dist(q, r), math.dist(p, r)) < edge:
                    determinant = (
                        p[0] * (q[1] * r[2] - q[2] * r[1])
                        - p[1] * (q[0] * r[2] - q[2] * r[0])
                        + p[2] * (q[0] * r[1] - q[1] * r[0])
                    )
                    triangles.append((i, j, k) if determinant > 0 else (i, k, j))
    for _ in range(subdivisions):
        midpoints, finer = {}, []

        def midpoint(i, j):
            key = (min(i, j), max(i, j))
            if key not in midpoints:
                midpoints[key] = len(positions)
                positions.append(normalized([a + b for a, b in zip(positions[i], positions[j])]))
            return midpoints[key]

        for a, b, c in triangles:
            ab, bc, ca = midpoint(a, b), midpoint(b, c), midpoint(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return positions, list(positions), triangles


def egg(half_height, radius, blunt, rings, segments):
    """An egg around the y axis, its blunt end down: at the angle a from the top, y is half_height cos(a), the distance
    from the axis radius sin(a) (1 - blunt cos(a)). Normals are those of that surface, from its derivative."""
    positions, normals, triangles = [(0.0, half_height, 0.0)], [(0.0, 1.0, 0.0)], []
    for i in range(1, rings):
        angle = math.pi * i / rings
        sine, cosine = math.sin(angle), math.cos(angle)
        distance, y = radius * sine * (1 - blunt * cosine), half_height * cosine
        distance_slope = radius * (cosine - blunt * (cosine * cosine - sine * sine))
        along_axis, outward = distance_slope, half_height * sine  # the profile's tangent, turned by a right angle
        for j in range(segments):
            around = 2 * math.pi * j / segments
            positions.append((distance * math.cos(around), y, distance * math.sin(around)))
            normals.append(normalized((outward * math.cos(around), along_axis, outward * math.sin(around))))
    last = len(positions)
    positions.append((0.0, -half_height, 0.0))
    normals.append((0.0, -1.0, 0.0))
    for j in range(segments):
        n = (j + 1) % segments
        triangles.append((0, 1 + n, 1 + j))
        for i in range(rings - 2):
            upper, lower = 1 + i * segments, 1 + (i + 1) * segments
            triangles += [(upper + j, upper + n, lower + n), (upper + j, lower + n, lower + j)]
        triangles.append((last, last - segments + j, last - segments + n))
    return positions, normals, triangles


def band(inner_radius, outer_radius, height, segments):
    """A ring of rectangular cross-section around the y axis, standing on y = 0. Each of its four sides has vertices of
    its own, so that the normals at them are exact."""
    inner, outer = inner_radius, outer_radius
    # Each side: two points (distance from the axis, y) of its profile, and the normal (outward, upward) there.
    sides = [((outer, 0.0), (outer, height), (1.0, 0.0)), ((outer, height), (inner, height), (0.0, 1.0)),
             ((inner, height), (inner, 0.0), (-1.0, 0.0)), ((inner, 0.0), (outer, 0.0), (0.0, -1.0))]
    positions, normals, triangles = [], [], []
    for start, end, (outward, upward) in sides:
        first = len(positions)
        for k in range(segments):
            around = 2 * math.pi * k / segments
            cosine, sine = math.cos(around), math.sin(around)
            for distance, y in (start, end):
                positions.append((distance * cosine, y, distance * sine))
                normals.append((outward * cosine, upward, outward * sine))
        for k in range(segments):
            a, b = first + 2 * k, first + 2 * ((k + 1) % segments)
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
    return positions, normals, triangles


def waves(half_x, half_z, columns, rows):
    """A rippled sheet over [-half_x, half_x] x [-half_z, half_z] around y = 0, a sum of waves that run in several
    directions, seen from above; its normals are those of the sum."""
    # Of each: wave numbers along x and z, height, phase.
    trains = [(7.1, 3.3, 0.014, 0.4), (-5.2, 8.6, 0.012, 1.9), (12.4, -6.1, 0.006, 3.1), (4.3, 15.2, 0.005, 5.2),
              (17.3, 9.9, 0.002, 0.7)]
    positions, normals, triangles = [], [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            x, z = half_x * (2 * column / columns - 1), half_z * (2 * row / rows - 1)
            y = slope_x = slope_z = 0.0
            for along_x, along_z, height, phase in trains:
                angle = along_x * x + along_z * z + phase
                y += height * math.sin(angle)
                slope_x += height * along_x * math.cos(angle)
                slope_z += height * along_z * math.cos(angle)
            positions.append((x, y, z))
            normals.append(normalized((-slope_x, 1.0, -slope_z)))
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b = a + columns + 1
            triangles += [(a, b, a + 1), (a + 1, b, b + 1)]
    return positions, normals, triangles


def star(points, outer_radius, inner_radius, half_thickness):
    """A star in the x-y plane with a bevelled front and back: (positions, faces of three or four indices)."""
    rim = []
    for k in range(2 * points):
        angle = math.pi / 2 + math.pi * k / points
        radius = outer_radius if k % 2 == 0 else inner_radius
        rim.append((radius * math.cos(angle), radius * math.sin(angle)))
    positions = [(x, y, z) for z in (half_thickness, -half_thickness) for x, y in rim]
    positions += [(0, 0, 3 * half_thickness), (0, 0, -3 * half_thickness)]
    count = len(rim)
    front_tip, back_tip = 2 * count, 2 * count + 1
    faces = []
    for k in range(count):
        n = (k + 1) % count
        faces.append((front_tip, k, n))
        faces.append((back_tip, count + n, count + k))
        faces.append((k, count + k, count + n, n))
    return positions, faces


def lanterns(strings, lanterns_of_string, group, groups):
    """Every third (`groups`) of the lanterns, octahedra 12 cm wide, that hang on strings which cross a court of 19 x 19
    in both directions and sag; the origin is on its ground."""
    positions, triangles = [], []
    for string in range(strings):
        across = -9 + 18 * (string // 2 + 0.5) / (strings // 2)
        for k in range(lanterns_of_string):
            if (k + string) % groups != group:
                continue
            along = 2 * (k + 0.5) / lanterns_of_string - 1
            y = 2.4 + 0.9 * along * along + 0.15 * math.sin(3 * string) + 0.1 * math.sin(7.3 * k + 2.1 * string)
            x, z = (9.5 * along, across) if string % 2 == 0 else (across, 9.5 * along)
            first = len(positions)
            for corner in range(4):
                angle = corner * math.pi / 2 + 0.3 + k
                positions.append((x + 0.06 * math.cos(angle), y, z + 0.06 * math.sin(angle)))
            positions += [(x, y + 0.09, z), (x, y - 0.09, z)]
            for corner in range(4):
                a, b = first + corner, first + (corner + 1) % 4
                triangles += [(a, first + 4, b), (a, b, first + 5)]
    return positions, None, triangles


def write_ply_binary(path, positions, normals, triangles):
    """Binary little-endian PLY: float positions, float normals where given, faces as uchar count and int indices."""
    properties = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals else [])
    header = ["ply", "format binary_little_endian 1.0", "comment made by scenes/generate.py"]
    header += [f"element vertex {len(positions)}"] + [f"property float {name}" for name in properties]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    data = bytearray(("\n".join(header) + "\n").encode())
    for k, position in enumerate(positions):
        data += struct.pack("<3f", *position)
        if normals:
            data += struct.pack("<3f", *normals[k])
    for triangle in triangles:
        data += struct.pack("<B3i", 3, *triangle)
    path.write_bytes(data)


def write_ply_ascii(path, positions, triangles):
    """ASCII PLY without normals."""
    lines = ["ply", "format ascii 1.0", "comment made by scenes/generate.py", f"element vertex {len(positions)}"]
    lines += ["property float x", "property float y", "property float z"]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{c:.6f}" for c in position) for position in positions]
    lines += ["3 " + " ".join(str(index) for index in triangle) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")


def write_obj(path, positions, faces):
    """Wavefront OBJ with one normal for each face (v//n), triangles and quads."""
    lines = ["# made by scenes/generate.py", "o star"]
    lines += ["v " + " ".join(f"{c:.6f}" for c in position) for position in positions]
    for face in faces:
        a, b, c = (positions[index] for index in face[:3])
        u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
        normal = normalized((u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]))
        lines.append("vn " + " ".join(f"{c:.6f}" for c in normal))
    for number, face in enumerate(faces, start=1):
        lines.append("f " + " ".join(f"{index + 1}//{number}" for index in face))
    path.write_text("\n".join(lines) + "\n")


def write_serialized(path, meshes):
    """Mitsuba's serialized format, version 4: (name, positions, normals or None, triangles) for each mesh.

    A mesh is a header (0x041C, 4) and a zlib stream of flags, name, counts and arrays; the file ends with the offset of
    each mesh (64 bits) and their number (32 bits), little endian throughout."""
    flag_has_normals, flag_single_precision = 0x0001, 0x1000
    data, offsets = bytearray(), []
    for name, positions, normals, triangles in meshes:
        offsets.append(len(data))
        flags = flag_single_precision | (flag_has_normals if normals else 0)
        body = struct.pack("<I", flags) + name.encode() + b"\0"
        body += struct.pack("<QQ", len(positions), len(triangles))
        for vectors in (positions, normals or []):
            for vector in vectors:
                body += struct.pack("<3f", *vector)
        for triangle in triangles:
            body += struct.pack("<3I", *triangle)
        data += struct.pack("<HH", 0x041C, 4) + zlib.compress(body, 9)
    data += b"".join(struct.pack("<Q", offset) for offset in offsets) + struct.pack("<I", len(offsets))
    path.write_bytes(data)


def sky(columns, rows):
    """Linear RGB by row from the zenith down: a blue sky that is brighter towards the horizon and about the sun, some
    clouds, brown ground, and a sun of about two texels. A texel's row is that of its angle from the zenith, pi * row /
    (rows - 1); its column's centre is that share of a turn."""
    sun = (0.31, 0.27)  # shares of a turn and of half a turn
    image = []
    for row in range(rows):
        height = row / (rows - 1)
        for column in range(columns):
            around = (column + 0.5) / columns
            turn = 2 * math.pi * (around - sun[0])
            polar, sun_polar = math.pi * height, math.pi * sun[1]
            cosine = math.cos(polar) * math.cos(sun_polar) + math.sin(polar) * math.sin(sun_polar) * math.cos(turn)
            angle = math.acos(max(-1.0, min(1.0, cosine)))
            if height > 0.5:
                shade = 0.7 + 0.3 * math.cos(9 * 2 * math.pi * around) * math.sin(polar)
                image.append((0.16 * shade, 0.12 * shade, 0.08 * shade))
                continue
            haze = 0.15 + 0.85 * (2 * height) ** 4
            wave = math.sin(3 * 2 * math.pi * around + 9 * height) * math.sin(5 * 2 * math.pi * around - 14 * height)
            cloud = max(0.0, wave) ** 2 * (1 - (2 * height) ** 2)
            glow = 1.2 * math.exp(-((angle / 0.3) ** 2))
            color = [0.22 + 0.5 * haze, 0.38 + 0.42 * haze, 0.75 + 0.2 * haze]
            color = [channel + 0.8 * cloud + glow * warm for channel, warm in zip(color, (1.0, 0.9, 0.7))]
            disc = 1100 * math.exp(-((angle / 0.04) ** 2))
            image.append(tuple(channel + disc * warm for channel, warm in zip(color, (1.0, 0.88, 0.7))))
    return image


def write_hdr(path, columns, rows, image):
    """Radiance's RGBE, without run lengths: three mantissas of eight bits and an exponent for each texel."""
    data = bytearray(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {rows} +X {columns}\n".encode())
    for color in image:
        _, exponent = math.frexp(max(color))
        data += bytes(min(255, int(channel * 2.0 ** (8 - exponent) + 0.5)) for channel in color)
        data.append(exponent + 128)
    path.write_bytes(data)


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description="writes the meshes of the project's own scenes")
    parser.add_argument("--output", type=pathlib.Path, default=here / "meshes", help="folder (default: meshes/)")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)

    write_ply_binary(folder / "torus.ply", *torus(0.5, 0.19, 64, 32))
    write_ply_binary(folder / "block.ply", *block(0.86, 0.42, 0.86))
    write_ply_binary(folder / "egg.ply", *egg(0.36, 0.27, 0.18, 36, 56))
    write_ply_binary(folder / "band.ply", *band(0.52, 0.56, 0.34, 128))
    write_ply_binary(folder / "waves.ply", *waves(1.0, 0.75, 64, 48))
    for group in range(3):
        write_ply_binary(folder / f"lanterns-{group}.ply", *lanterns(24, 25, group, 3))
    for count in (7, 14, 28):
        write_ply_binary(folder / f"holes-{count}.ply", *perforated_plane(count, 0.78))
    write_obj(folder / "star.obj", *star(5, 1.0, 0.45, 0.14))
    positions, _, triangles = icosphere(2)
    write_ply_ascii(folder / "ball.ply", positions, triangles)
    write_hdr(folder / "sky.hdr", 128, 61, sky(128, 61))
    ring = torus(0.7, 0.28, 32, 16)
    write_serialized(folder / "pair.serialized", [("ring", *ring), ("gem", *icosphere(1))])


if __name__ == "__main__":
    main()
