#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures and the model that the scenes in this folder use; needs nothing but Python's own library.

    python3 scenes/make_assets.py

writes images/*.hdr, images/*.png, models/*.glb and models/*.json beside itself. What it makes is in the repository: run it only
after changing it.
"""
import json
import math
import pathlib
import struct
import zlib

HERE = pathlib.Path(__file__).parent


# ------------------------------------------------------------------------------------------------ noise and vectors
def lattice(*ints):
    """A number in [0, 1) that depends on the integers alone."""
    h = 2166136261
    for i in ints:
        h = ((h ^ (i & 0xffffffff)) * 16777619) & 0xffffffff
        h ^= h >> 15
        h = (h * 2246822519) & 0xffffffff
    return (h ^ h >> 13) / 2**32


def noise(x, y, z):
    """Smooth value noise in [0, 1)."""
    xi, yi, zi = math.floor(x), math.floor(y), math.floor(z)
    u, v, w = (t * t * (3 - 2 * t) for t in (x - xi, y - yi, z - zi))
    mix = lambda a, b, t: a + (b - a) * t
    corner = lambda i, j, k: lattice(xi + i, yi + j, zi + k)
    return mix(mix(mix(corner(0, 0, 0), corner(1, 0, 0), u), mix(corner(0, 1, 0), corner(1, 1, 0), u), v),
               mix(mix(corner(0, 0, 1), corner(1, 0, 1), u), mix(corner(0, 1, 1), corner(1, 1, 1), u), v), w)


def fractal(x, y, z, octaves=5):
    total = sum(noise(x * 2**i, y * 2**i, z * 2**i) / 2**i for i in range(octaves))
    return total / (2 - 2**(1 - octaves))


def mix(a, b, t):
    return tuple(p + (q - p) * t for p, q in zip(a, b))


def normalize(v):
    size = math.sqrt(sum(c * c for c in v))
    return tuple(c / size for c in v)


def smooth(low, high, x):
    t = min(max((x - low) / (high - low), 0), 1)
    return t * t * (3 - 2 * t)


# ------------------------------------------------------------------------------------------------ files
def png(width, height, pixel):
    """An RGB PNG; pixel(x, y) gives three values in [0, 1] as they are to stand in the file."""
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            rows += bytes(min(max(round(255 * c), 0), 255) for c in pixel(x, y))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b"")


def rgbe(color):
    largest = max(color)
    if largest < 1e-32:
        return bytes(4)
    mantissa, exponent = math.frexp(largest)
    return bytes([*(int(c * mantissa * 256 / largest) for c in color), exponent + 128])


def run_lengths(values):
    """One channel of a scanline as Radiance's new run length encoding: runs from 4 on, the rest as it is."""
    out, i, literal = bytearray(), 0, bytearray()

    def flush():
        while literal:
            out.append(min(len(literal), 128))
            out.extend(literal[:128])
            del literal[:128]

    while i < len(values):
        run = 1
        while run < 127 and i + run < len(values) and values[i + run] == values[i]:
            run += 1
        if run >= 4:
            flush()
            out += bytes([128 + run, values[i]])
        else:
            literal += values[i:i + run]
        i += run
    flush()
    return bytes(out)


def hdr(width, height, pixel):
    out = bytearray(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode())
    for y in range(height):
        row = [rgbe(pixel(x, y)) for x in range(width)]
        out += bytes([2, 2, width >> 8, width & 255])
        for channel in range(4):
            out += run_lengths(bytes(p[channel] for p in row))
    return bytes(out)


# ------------------------------------------------------------------------------------------------ pictures
def sky(width, height):
    """An afternoon: clouds, a sun that is 3 degrees wide, a meadow below the horizon."""
    sun = normalize((0.56, 0.62, -0.55))

    def pixel(px, py):
        theta, phi = math.pi * (py + 0.5) / height, 2 * math.pi * ((px + 0.5) / width - 0.5)
        # The middle of the picture looks along +x, its right edge is behind.
        x, y, z = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
        to_sun = z * sun[2] + y * sun[1] + x * sun[0]
        if y < 0:
            shade = 0.75 + 0.5 * fractal(6 * z / (0.1 - y), -6 * x / (0.1 - y), 1, 3)
            ground = mix((0.50, 0.52, 0.50), (0.16, 0.19, 0.08), smooth(0, 0.25, -y))
            return tuple(c * shade for c in ground)
        color = mix((0.75, 0.85, 1.0), (0.16, 0.33, 0.78), smooth(0, 0.8, y))
        cover = smooth(0.47, 0.68, fractal(1.4 * z / (y + 0.15), 7, -1.4 * x / (y + 0.15))) * smooth(0.02, 0.2, y)
        color = mix(color, (1.15, 1.12, 1.08), 0.85 * cover)
        glow = max(to_sun, 0)
        color = tuple(c + g * (0.5 * glow**32 + 2.5 * glow**400) for c, g in zip(color, (1, 0.85, 0.6)))
        if to_sun > math.cos(math.radians(1.5)):
            color = (900, 800, 620)
        return color

    return hdr(width, height, pixel)


def tiles(x, y, size):
    """Glazed tiles, four by four: colour and height."""
    u, v = 4 * (x + 0.5) / size, 4 * (y + 0.5) / size
    i, j = int(u), int(v)
    edge = min(u - i, v - j, i + 1 - u, j + 1 - v)
    glaze = smooth(0.03, 0.07, edge)
    base = mix((0.10, 0.33, 0.45), (0.85, 0.80, 0.66), lattice(i, j, 3) if (i + j) % 2 else 0.15 * lattice(i, j))
    ring = smooth(0.02, 0.03, abs(math.hypot(u - i - 0.5, v - j - 0.5) - 0.27))
    base = mix((0.70, 0.25, 0.12), base, ring)
    speckle = 0.9 + 0.2 * fractal(24 * u / 4, 24 * v / 4, 5, 3)
    color = mix((0.45, 0.43, 0.40), tuple(c * speckle for c in base), glaze)
    return color, glaze


def tiles_normal(x, y, size):
    height = lambda a, b: 1.5 * tiles(a % size, b % size, size)[1]
    dx, dy = height(x + 1, y) - height(x - 1, y), height(x, y + 1) - height(x, y - 1)
    # Green points up in the picture (glTF), rows go down.
    n = normalize((-dx, dy, 2))
    return tuple(0.5 + 0.5 * c for c in n)


def globe(x, y, width, height):
    """A planet that does not exist, with a grid to see the mapping by."""
    theta, phi = math.pi * (y + 0.5) / height, 2 * math.pi * (x + 0.5) / width
    px, py, pz = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
    land = fractal(2.3 * px + 5, 2.3 * py + 5, 2.3 * pz + 5)
    if land > 0.52:
        color = mix((0.30, 0.48, 0.20), (0.62, 0.53, 0.38), smooth(0.52, 0.66, land))
    else:
        color = mix((0.05, 0.13, 0.32), (0.16, 0.42, 0.58), smooth(0.36, 0.52, land))
    color = mix(color, (0.95, 0.96, 0.98), smooth(0.80, 0.88, abs(py) + 0.2 * (land - 0.5)))
    grid = min(abs((12 * x / width + 0.5) % 1 - 0.5) * width / 12, abs((6 * y / height + 0.5) % 1 - 0.5) * height / 6)
    return mix((1.0, 0.85, 0.4), color, smooth(0.5, 1.5, grid))


# ------------------------------------------------------------------------------------------------ the model
def lathe(profile, sides):
    """Turns a polyline of (radius, height) around y: positions, normals, uvs, indices. Smooth along the profile, but for points that
    stand there twice, which make an edge."""
    positions, normals, uvs, indices = [], [], [], []
    for i, (r, h) in enumerate(profile):
        before, after = profile[max(i - 1, 0)], profile[min(i + 1, len(profile) - 1)]
        along = normalize((after[0] - before[0], after[1] - before[1]))
        for j in range(sides + 1):
            c, s = math.cos(2 * math.pi * j / sides), math.sin(2 * math.pi * j / sides)
            positions.append((r * c, h, -r * s))
            normals.append((along[1] * c, -along[0], -along[1] * s))
            uvs.append((2 * j / sides, 1 - i / (len(profile) - 1)))
    for i in range(len(profile) - 1):
        if profile[i] == profile[i + 1]:
            continue
        for j in range(sides):
            a, b = i * (sides + 1) + j, (i + 1) * (sides + 1) + j
            if profile[i][0] > 0:
                indices += [a, a + 1, b + 1]
            if profile[i + 1][0] > 0:
                indices += [a, b + 1, b]
    return positions, normals, uvs, indices


def curve(points, steps):
    """Catmull-Rom through the points; a point given twice makes a corner."""
    out = []
    for i in range(len(points) - 1):
        p = [points[min(max(k, 0), len(points) - 1)] for k in range(i - 1, i + 3)]
        if p[1] == p[2]:
            continue
        for s in range(steps):
            t = s / steps
            out.append(tuple(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t**3)
                             for a, b, c, d in zip(*p)))
    return [(max(r, 0), h) for r, h in out] + [points[-1]]


def pawn():
    foot = [(0.30, 0), (0.34, 0.03), (0.34, 0.10), (0.28, 0.16), (0.29, 0.20), (0.22, 0.26), (0.15, 0.40), (0.12, 0.56),
            (0.13, 0.62), (0.20, 0.65), (0.20, 0.68), (0.12, 0.70)]
    head = [(0.17 * math.sin(a), 0.84 - 0.17 * math.cos(a)) for a in (math.pi * (0.26 + 0.74 * i / 12) for i in range(13))]
    head[-1] = (0, 1.01)
    return lathe(curve(foot, 4) + head, 48)


def rook():
    points = [(0.34, 0), (0.38, 0.03), (0.38, 0.12), (0.31, 0.18), (0.32, 0.23), (0.24, 0.30), (0.21, 0.60), (0.21, 0.78),
              (0.28, 0.84), (0.29, 0.86), (0.29, 0.86), (0.29, 1.04), (0.29, 1.04), (0.22, 1.04), (0.22, 1.04), (0.22, 0.94),
              (0.22, 0.94), (0, 0.94)]
    return lathe(curve(points, 4), 48)


def board():
    """A slab of 8 x 2 x 8 hundredths under y = 0: a face at a time, so that edges are sharp."""
    positions, normals, uvs, indices = [], [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            n = tuple(sign if k == axis else 0 for k in range(3))
            a, b = [k for k in range(3) if k != axis]
            if (axis == 1) != (sign < 0):
                a, b = b, a
            first = len(positions)
            for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
                p = [0, 0, 0]
                p[axis], p[a], p[b] = sign, 2 * s - 1, 2 * t - 1
                positions.append((4.3 * p[0], 0.15 * p[1] - 0.15, 4.3 * p[2]))
                normals.append(n)
                uvs.append(((p[0] + 1) / 2, (p[2] + 1) / 2) if axis == 1 else (s * 0.02, t * 0.02))
            indices += [first, first + 1, first + 2, first, first + 2, first + 3]
    return positions, normals, uvs, indices


def board_color(x, y, size):
    u, v = 8.6 * (x + 0.5) / size - 0.3, 8.6 * (y + 0.5) / size - 0.3
    grain = fractal(3 * u, 40 * v, 2, 3) if int(u + 1) % 2 else fractal(40 * u, 3 * v, 2, 3)
    if not (0 < u < 8 and 0 < v < 8):
        return mix((0.22, 0.11, 0.06), (0.33, 0.17, 0.09), grain)
    if (int(u) + int(v)) % 2 == 0:
        return mix((0.80, 0.66, 0.45), (0.92, 0.80, 0.60), grain)
    return mix((0.30, 0.15, 0.08), (0.44, 0.24, 0.13), grain)


def board_surface(x, y, size):
    """Roughness in green, metallic in blue: lacquer with a few worn spots and a brass border."""
    u, v = 8.6 * (x + 0.5) / size - 0.3, 8.6 * (y + 0.5) / size - 0.3
    inlay = 1 if abs(max(abs(u - 4), abs(v - 4)) - 4.05) < 0.045 else 0
    worn = smooth(0.45, 0.7, fractal(u, v, 9, 4))
    return (1, 0.25 if inlay else 0.22 + 0.4 * worn, inlay)


def brushed(x, y, size):
    """A normal map of rings as a lathe leaves them."""
    n = normalize((0, 0.25 * (lattice(y, 4) - 0.5), 1))
    return tuple(0.5 + 0.5 * c for c in n)


class Glb:
    """A binary glTF file in the making."""

    def __init__(self):
        self.document = {
            "asset": {"version": "2.0", "generator": "Fathom's scenes/make_assets.py"},
            "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "textures": [], "images": [],
            "samplers": [{"magFilter": 9729, "minFilter": 9987}], "accessors": [], "bufferViews": [], "buffers": [],
        }
        self.data = bytearray()

    def view(self, payload, target=None):
        self.data.extend(bytes(-len(self.data) % 4))
        entry = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(payload)}
        if target:
            entry["target"] = target
        self.data.extend(payload)
        self.document["bufferViews"].append(entry)
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values, kind, with_bounds=False):
        if kind == "SCALAR":
            entry = {"bufferView": self.view(struct.pack(f"<{len(values)}H", *values), 34963), "componentType": 5123}
        else:
            flat = [c for value in values for c in value]
            entry = {"bufferView": self.view(struct.pack(f"<{len(flat)}f", *flat), 34962), "componentType": 5126}
        entry.update(count=len(values), type=kind)
        if with_bounds:
            rounded = lambda pick: [struct.unpack("<f", struct.pack("<f", pick(c)))[0] for c in zip(*values)]
            entry.update(min=rounded(min), max=rounded(max))
        self.document["accessors"].append(entry)
        return len(self.document["accessors"]) - 1

    def texture(self, size, pixel):
        picture = self.view(png(size, size, lambda x, y: pixel(x, y, size)))
        self.document["images"].append({"bufferView": picture, "mimeType": "image/png"})
        self.document["textures"].append({"sampler": 0, "source": len(self.document["images"]) - 1})
        return {"index": len(self.document["textures"]) - 1}

    def material(self, name, **properties):
        self.document["materials"].append({"name": name, **properties})
        return len(self.document["materials"]) - 1

    def primitive(self, shape, material):
        """shape: positions, and normals, uvs and indices or None instead of each."""
        positions, normals, uvs, indices = shape
        attributes = {"POSITION": self.accessor(positions, "VEC3", with_bounds=True)}
        if normals:
            attributes["NORMAL"] = self.accessor(normals, "VEC3")
        if uvs:
            attributes["TEXCOORD_0"] = self.accessor(uvs, "VEC2")
        made = {"attributes": attributes}
        if indices:
            made["indices"] = self.accessor(indices, "SCALAR")
        return {**made, "material": material}

    def mesh(self, name, primitive):
        self.document["meshes"].append({"name": name, "primitives": [primitive]})
        return len(self.document["meshes"]) - 1

    def node(self, name, mesh, **place):
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]))
        self.document["nodes"].append({"name": name, "mesh": mesh, **place})

    def file(self):
        self.data.extend(bytes(-len(self.data) % 4))
        document = {key: value for key, value in self.document.items() if value != []}
        document["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + len(self.data)
        return (struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON") + text +
                struct.pack("<I4s", len(self.data), b"BIN\0") + self.data)


def chess():
    glb = Glb()
    rings = glb.texture(64, brushed)
    lacquer = glb.material("board", pbrMetallicRoughness={"baseColorTexture": glb.texture(192, board_color),
                                                          "metallicRoughnessTexture": glb.texture(192, board_surface)})
    brass = glb.material("brass", pbrMetallicRoughness={"baseColorFactor": [0.91, 0.70, 0.33, 1], "roughnessFactor": 0.25},
                         normalTexture=rings)
    ebony = glb.material("ebony", pbrMetallicRoughness={"baseColorFactor": [0.035, 0.025, 0.02, 1], "metallicFactor": 0,
                                                        "roughnessFactor": 0.35})
    meshes, primitives = {}, {}
    for name, shape, surface in (("board", board(), lacquer), ("brass pawn", pawn(), brass), ("ebony pawn", pawn(), ebony),
                                 ("brass rook", rook(), brass), ("ebony rook", rook(), ebony)):
        twin = name.replace("ebony", "brass")
        primitives[name] = {**primitives[twin], "material": surface} if twin in primitives else glb.primitive(shape, surface)
        meshes[name] = glb.mesh(name, primitives[name])

    def place(mesh, column, row):
        glb.node(f"{mesh} {'abcdefgh'[column]}{row + 1}", meshes[mesh], translation=[column - 3.5, 0, 3.5 - row])

    glb.node("board", meshes["board"])
    for column, row in ((0, 1), (1, 1), (2, 2), (3, 3), (5, 1), (6, 2), (7, 1)):
        place("brass pawn", column, row)
    for column, row in ((0, 6), (1, 5), (2, 6), (3, 4), (4, 5), (6, 6), (7, 5)):
        place("ebony pawn", column, row)
    for mesh, column, row in (("brass rook", 4, 0), ("brass rook", 0, 0), ("ebony rook", 4, 7), ("ebony rook", 7, 7)):
        place(mesh, column, row)
    return glb.file()


# ------------------------------------------------------------------------------------------------ the still life
def goblet():
    """A wine glass of one closed wall: out along its foot, stem and bowl, over the rim, and down inside."""
    outside = [(0, 0), (0.40, 0), (0.40, 0.012), (0.36, 0.028), (0.20, 0.06), (0.07, 0.13), (0.038, 0.25), (0.035, 0.45), (0.038, 0.66),
               (0.07, 0.78), (0.20, 0.86), (0.36, 1.00), (0.455, 1.20), (0.465, 1.42), (0.42, 1.68), (0.37, 1.90)]
    inside = [(0.362, 1.905), (0.355, 1.90), (0.405, 1.68), (0.448, 1.42), (0.438, 1.205), (0.345, 1.02), (0.19, 0.89), (0.08, 0.845),
              (0, 0.84)]
    return lathe(curve(outside, 4) + curve(inside, 4), 72)


def wine():
    """Reaches into the wall of the goblet, whose priority is greater."""
    side = [(0, 0.83), (0.08, 0.838), (0.20, 0.88), (0.352, 1.01), (0.446, 1.20), (0.452, 1.24), (0.452, 1.24)]
    return lathe(curve(side, 4) + [(0.452, 1.24), (0, 1.24)], 72)


def bowl():
    points = [(0, 0), (0.30, 0), (0.32, 0.03), (0.30, 0.06), (0.42, 0.10), (0.72, 0.27), (0.92, 0.52), (0.96, 0.60), (0.955, 0.615),
              (0.945, 0.60), (0.90, 0.53), (0.70, 0.30), (0.40, 0.14), (0, 0.11)]
    return lathe(curve(points, 4), 72)


def jar():
    """A ginger jar: body, neck, and a lid with a knob."""
    points = [(0, 0), (0.36, 0), (0.38, 0.03), (0.38, 0.03), (0.40, 0.10), (0.56, 0.45), (0.66, 0.85), (0.62, 1.18), (0.46, 1.38),
              (0.34, 1.45), (0.33, 1.50), (0.33, 1.50), (0.43, 1.50), (0.43, 1.50), (0.445, 1.53), (0.44, 1.60), (0.36, 1.70),
              (0.18, 1.77), (0.08, 1.79), (0.07, 1.83), (0.11, 1.88), (0.10, 1.95), (0.05, 1.985), (0, 1.99)]
    return lathe(curve(points, 4), 72)


def pear():
    points = [(0, 0.03), (0.07, 0.0), (0.22, 0.03), (0.36, 0.18), (0.40, 0.36), (0.35, 0.55), (0.25, 0.72), (0.19, 0.88), (0.14, 0.98),
              (0.06, 1.025), (0.02, 1.01), (0, 1.0)]
    return lathe(curve(points, 4), 48)


def stalk():
    points = [(0, 0.97), (0.022, 0.97), (0.018, 1.06), (0.020, 1.18), (0.030, 1.24), (0.024, 1.255), (0, 1.257)]
    return lathe(curve(points, 3), 12)


def gem():
    """A brilliant of flat faces that stands on its point: table, star, kites and halves of the crown, girdle, pavilion."""
    def ring(radius, height, sides, turn=0.0):
        angles = [2 * math.pi * (k + turn) / sides for k in range(sides)]
        return [(radius * math.cos(a), height, -radius * math.sin(a)) for a in angles]

    top, point = (0, 1.22, 0), (0, 0, 0)
    table, star, lower = ring(0.55, 1.22, 8), ring(0.785, 1.10, 8, 0.5), ring(0.22, 0.19, 8, 0.5)
    upper, under = ring(1, 0.90, 16), ring(1, 0.86, 16)
    faces = []
    for k in range(8):
        n, i, j, l = (k + 1) % 8, 2 * k, 2 * k + 1, (2 * k + 2) % 16
        faces += [[top, table[k], table[n]], [table[k], star[k], table[n]], [table[k], star[k - 1], upper[i], star[k]],
                  [star[k], upper[i], upper[j]], [star[k], upper[j], upper[l]],
                  [point, lower[k], under[i], lower[k - 1]], [lower[k], under[j], under[i]], [lower[k], under[l], under[j]]]
    faces += [[upper[k], under[k], under[(k + 1) % 16], upper[(k + 1) % 16]] for k in range(16)]
    return [p for face in faces for i in range(1, len(face) - 1) for p in (face[0], face[i], face[i + 1])], None, None, None


def curtain():
    """Hangs in folds that wander, 13 wide and 6.5 high."""
    def point(u, v):
        x = 13 * (u - 0.5)
        phase = 3.4 * x + 0.7 * math.sin(1.1 * x) + 2.5 * fractal(0.6 * x, 0.25 * v, 5, 3)
        return (x, 6.5 * (1 - v), 0.30 * math.sin(phase) * (0.6 + 0.4 * v) + 0.10 * math.sin(2.3 * phase + 1))

    columns, rows = 200, 12
    grid = [[point(i / columns, j / rows) for i in range(columns + 1)] for j in range(rows + 1)]
    normals, indices = [], []
    for j in range(rows + 1):
        for i in range(columns + 1):
            a, b = grid[j][max(i - 1, 0)], grid[j][min(i + 1, columns)]
            c, d = grid[min(j + 1, rows)][i], grid[max(j - 1, 0)][i]
            e, f = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(c, d)]
            normals.append(normalize((e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0])))
            if i < columns and j < rows:
                k = j * (columns + 1) + i
                indices += [k, k + columns + 2, k + 1, k, k + columns + 1, k + columns + 2]
    return [p for row in grid for p in row], normals, None, indices


def turned(axis, degrees):
    """A quaternion, as glTF has them."""
    half = math.radians(degrees) / 2
    return [c * math.sin(half) for c in normalize(axis)] + [math.cos(half)]


def still_life():
    """Shapes in their places; scenes/still-life.json gives them their materials."""
    glb = Glb()
    bare = lambda shape: (shape[0], shape[1], None, shape[3])
    shapes = {"goblet": bare(goblet()), "wine": bare(wine()), "bowl": bowl(), "jar": jar(), "pear": bare(pear()),
              "stalk": bare(stalk()), "gem": gem(), "curtain": curtain()}
    meshes = {name: glb.mesh(name, glb.primitive(shape, glb.material(name))) for name, shape in shapes.items()}
    for name, place in PLACES:
        glb.node(name, meshes[name], **place)
    return glb.file()


PLACES = (
    ("curtain", {"translation": [0, -0.5, -3.2]}),
    ("jar", {"translation": [-1.62, 0, -0.75], "scale": [1.05, 1.05, 1.05]}),
    ("bowl", {"translation": [-0.12, 0, -0.1]}),
    ("goblet", {"translation": [1.32, 0, -0.35]}),
    ("wine", {"translation": [1.32, 0, -0.35]}),
    *((part, place) for part in ("pear", "stalk") for place in (
        {"translation": [-0.38, 0.20, -0.12], "rotation": turned((0, 0, 1), 14)},
        {"translation": [0.24, 0.24, -0.22], "rotation": turned((0.3, 0, 1), -17), "scale": [0.96, 0.96, 0.96]},
        {"translation": [-1.0, 0.39, 0.78], "rotation": turned((0.5, 0.3, -1), 84), "scale": [0.95, 0.95, 0.95]})),
    ("gem", {"translation": [-1.62, 0, 1.12], "rotation": turned((0.25, 0, -1), 40.7), "scale": [0.27, 0.27, 0.27]}),
)


def grapes():
    """A bunch that lies on the table, as a scene file of its own: berries that were pushed off each other and off the table."""
    count, berries = 52, []
    for k in range(count):
        t, angle = (k + 0.5) / count, 2.399963 * k
        away = (0.30 - 0.20 * t) * math.sqrt(lattice(k, 1))
        berries.append([1.25 * (t - 0.45), 0.25 + away * math.sin(angle), away * math.cos(angle), 0.105 + 0.025 * lattice(k, 2)])
    for _ in range(200):
        for i, a in enumerate(berries):
            a[1] = max(a[1] - 0.004, a[3])
            for b in berries[:i]:
                between = [q - p for p, q in zip(a[:3], b[:3])]
                away = math.sqrt(sum(c * c for c in between))
                push = max(a[3] + b[3] - away, 0) / (2 * away)
                for c in range(3):
                    a[c], b[c] = a[c] - push * between[c], b[c] + push * between[c]
        for a in berries:
            a[0], a[2] = 0.998 * a[0], 0.994 * a[2]
    rounded = [[round(c, 4) for c in berry] for berry in berries]
    return scene_file({"scene": [{"name": "grapes", "points": {"points": rounded}}]})


def flag():
    """Cloth in the wind, as a scene file of its own: two positions of each vertex, a fiftieth of a second apart."""
    columns, rows = 24, 16

    def vertex(i, j, time):
        u, v = i / columns, j / rows
        phase = 9 * u - 3 * v - 4.5 * time
        z = 0.22 * u**0.7 * math.sin(phase) + 0.05 * u * math.sin(2.3 * phase + 5 * v)
        return [round(x, 4) for x in (1.8 * u - 0.1 * u * math.cos(phase), 1.2 * (v - 1) - 0.08 * u * u, z)]

    def normals(points):
        at = lambda i, j: points[j * (columns + 1) + i]
        result = []
        for j in range(rows + 1):
            for i in range(columns + 1):
                a, b = at(max(i - 1, 0), j), at(min(i + 1, columns), j)
                c, d = at(i, max(j - 1, 0)), at(i, min(j + 1, rows))
                e, f = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(c, d)]
                n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
                length = math.sqrt(sum(x * x for x in n))
                result.append([round(x / length, 3) for x in n])
        return result

    keys = [[vertex(i, j, time) for j in range(rows + 1) for i in range(columns + 1)] for time in (0, 1)]
    indices = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            indices += [[a, a + 1, a + columns + 2], [a, a + columns + 2, a + columns + 1]]
    mesh = {"positions": keys[0], "normals": normals(keys[0]), "indices": indices,
            "uvs": [[round(i / columns, 4), round(j / rows, 4)] for j in range(rows + 1) for i in range(columns + 1)],
            "motion": [{"time": 0}, {"time": 0.02, "positions": keys[1], "normals": normals(keys[1])}]}
    return scene_file({"meshes": {"cloth": mesh}, "scene": [{"name": "flag", "mesh": "cloth"}]})


def tuft():
    """A round patch of long grass, as a scene file of its own: B-splines that bend to all sides, thinner towards their tips."""
    blades = []
    for k in range(900):
        angle, away = 2.399963 * k, 0.5 * math.sqrt((k + 0.5) / 900)
        x, z = away * math.cos(angle), away * math.sin(angle)
        height, bend = 0.45 + 0.4 * lattice(k, 1), 0.5 * lattice(k, 2)
        turn = angle + 2 * (lattice(k, 3) - 0.5)
        dx, dz = math.cos(turn), math.sin(turn)
        points = []
        for i in range(-1, 5):
            t = i / 3
            lean = bend * t * t * height
            points.append([round(x + dx * lean, 4), round(height * (t - 0.25 * bend * t * t), 4), round(z + dz * lean, 4),
                           round(0.007 * max(0.08, 1 - 0.8 * t), 5)])
        blades.append(points)
    return scene_file({"scene": [{"name": "tuft", "curves": {"style": "round", "curves": blades}}]})


def spray():
    """Drops thrown up from a pool, as a scene file of its own."""
    drops = []
    for k in range(8000):
        a, b, c, d = (lattice(k, i) for i in range(4))
        time, up, out = 0.05 + 0.85 * a, 2.2 + 1.6 * b * b, 0.25 + 0.9 * c**1.5
        angle = 2 * math.pi * d + 0.3 * math.sin(5 * d * 2 * math.pi)
        y = up * time - 4.2 * time * time
        if y < 0:
            continue
        radius = 0.004 + 0.02 * lattice(k, 4)**4
        drops.append([round(out * time * math.cos(angle), 4), round(y, 4), round(out * time * math.sin(angle), 4), round(radius, 5)])
    return scene_file({"scene": [{"name": "drops", "points": {"points": drops}}]})


def scene_file(content):
    return json.dumps({"fathom": 1, **content}, separators=(",", ":")).encode() + b"\n"


def main():
    for name, content in (("models/flag.json", flag()),
                          ("models/tuft.json", tuft()),
                          ("models/spray.json", spray()),
                          ("images/sky.hdr", sky(360, 180)),
                          ("images/tiles.png", png(256, 256, lambda x, y: tiles(x, y, 256)[0])),
                          ("images/tiles-normal.png", png(256, 256, lambda x, y: tiles_normal(x, y, 256))),
                          ("images/globe.png", png(384, 192, lambda x, y: globe(x, y, 384, 192))),
                          ("models/grapes.json", grapes()),
                          ("models/still-life.glb", still_life()),
                          ("models/chess.glb", chess())):
        path = HERE / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        print(f"{path}: {len(content)} bytes")


if __name__ == "__main__":
    main()
