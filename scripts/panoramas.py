#!/usr/bin/env python3
"""Makes panoramas of three places to light pictures with, of their own and always the same bytes.

  scripts/panoramas.py FOLDER    writes operating-theatre.hdr, photo-studio.hdr and window.hdr into FOLDER

Use one as `clipgs cinema ct.nii.gz -o out.png --rig FOLDER/photo-studio.hdr`. They are Radiance HDR, 512 x 256,
longitude over latitude: superior at the top, anterior in the middle, the patient's right to the left of it.
Needs nothing but Python 3.
"""
import math
import os
import sys

WIDTH, HEIGHT = 512, 256
SAMPLES = 2  # along a side of a pixel: edges are smooth


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def towards(azimuth, elevation):
    """Right, anterior, superior; azimuth in degrees from anterior towards the patient's left."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return (-math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e))


def smooth(low, high, x):
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3 - 2 * t)


class Softbox:
    """A rectangle that glows, seen `across` x `up` degrees large; a little darker towards its edges."""

    def __init__(self, azimuth, elevation, across, up, color, bars=0):
        self.axis = towards(azimuth, elevation)
        pole = (0.0, 0.0, 1.0) if abs(self.axis[2]) < 0.99 else (0.0, 1.0, 0.0)
        self.side = unit(cross(self.axis, pole))
        self.top = cross(self.side, self.axis)
        self.half = (math.tan(math.radians(across / 2)), math.tan(math.radians(up / 2)))
        self.color = color
        self.bars = bars  # of a window: that many panes along each side

    def at(self, direction):
        depth = dot(direction, self.axis)
        if depth <= 0:
            return None
        x = dot(direction, self.side) / depth / self.half[0]
        y = dot(direction, self.top) / depth / self.half[1]
        if abs(x) > 1 or abs(y) > 1:
            return None
        if self.bars and min(abs((c + 1) / 2 * self.bars - round((c + 1) / 2 * self.bars)) for c in (x, y)) < 0.06:
            return (0.05, 0.04, 0.03)
        share = 1 - 0.35 * (x * x + y * y) / 2
        return tuple(share * c for c in self.color)


class Lamp:
    """A disc that glows, of a radius in degrees."""

    def __init__(self, azimuth, elevation, radius, color):
        self.axis = towards(azimuth, elevation)
        self.cosine = math.cos(math.radians(radius))
        self.color = color

    def at(self, direction):
        return self.color if dot(direction, self.axis) >= self.cosine else None


def room(floor, wall, ceiling):
    """From the floor to the ceiling, by the height of a direction."""

    def at(direction):
        z = direction[2]
        if z < 0:
            return tuple(w + (f - w) * smooth(0.0, 0.9, -z) for f, w in zip(floor, wall))
        return tuple(w + (c - w) * smooth(0.0, 0.9, z) for c, w in zip(ceiling, wall))

    return at


def operating_theatre():
    """Seven round lamps around one above a patient who lies on the back, in a room of pale green tiles."""
    lamps = [Lamp(0, 52, 7, (60.0, 58.0, 54.0))]
    axis, side = towards(0, 52), (1.0, 0.0, 0.0)
    up = cross(side, axis)
    for i in range(7):
        turn = 2 * math.pi * i / 7
        tilt = math.tan(math.radians(19))
        at = unit(tuple(a + tilt * (math.cos(turn) * s + math.sin(turn) * u) for a, s, u in zip(axis, side, up)))
        lamp = Lamp(0, 0, 6, (46.0, 45.0, 43.0))
        lamp.axis = at
        lamps.append(lamp)
    return room((0.10, 0.12, 0.12), (0.22, 0.27, 0.26), (0.34, 0.38, 0.38)), lamps


def photo_studio():
    """A large key from the upper right, a strip behind each shoulder, a dim fill, all in a dark room."""
    return room((0.03, 0.03, 0.03), (0.05, 0.05, 0.055), (0.08, 0.08, 0.085)), [
        Softbox(-45, 35, 55, 55, (9.0, 8.6, 8.1)),
        Softbox(70, 10, 45, 70, (0.9, 1.0, 1.15)),
        Softbox(140, 15, 10, 95, (11.0, 11.6, 12.4)),
        Softbox(-145, 15, 10, 95, (11.0, 11.6, 12.4)),
    ]


def window():
    """A tall window of six panes to the right, in a warm room with a reading lamp."""
    return room((0.16, 0.10, 0.06), (0.34, 0.26, 0.18), (0.48, 0.42, 0.34)), [
        Softbox(-55, 12, 48, 84, (7.2, 8.4, 10.4), bars=3),
        Lamp(75, -5, 7, (13.0, 8.2, 4.0)),
    ]


def radiance(place, direction):
    background, lights = place
    for light in lights:
        color = light.at(direction)
        if color is not None:
            return color
    return background(direction)


def circle(count, turn):
    """Sine and cosine of the middles of `count` parts of a turn around its middle."""
    angles = [turn * ((i + 0.5) / count - 0.5) for i in range(count)]
    return [(math.sin(a), math.cos(a)) for a in angles]


LONGITUDES = circle(WIDTH * SAMPLES, 2 * math.pi)
LATITUDES = circle(HEIGHT * SAMPLES, math.pi)


def pixel(place, column, row):
    red = green = blue = 0.0
    for down, level in LATITUDES[row * SAMPLES : (row + 1) * SAMPLES]:
        for left, front in LONGITUDES[column * SAMPLES : (column + 1) * SAMPLES]:
            r, g, b = radiance(place, (-left * level, front * level, -down))
            red, green, blue = red + r, green + g, blue + b
    return (red / SAMPLES**2, green / SAMPLES**2, blue / SAMPLES**2)


def rgbe(color):
    """Three mantissas and their exponent."""
    most = max(color)
    if most < 1e-32:
        return (0, 0, 0, 0)
    exponent = math.frexp(most)[1]
    scale = 256 / 2**exponent
    return (*(min(255, int(c * scale)) for c in color), exponent + 128)


def packed(values):
    """Radiance's run-length code: runs of four and more, and copies of the rest."""
    out = bytearray()
    at = 0
    copy_from = 0

    def copy(end):
        for begin in range(copy_from, end, 128):
            part = values[begin : min(begin + 128, end)]
            out.append(len(part))
            out.extend(part)

    while at < len(values):
        run = 1
        while at + run < len(values) and run < 127 and values[at + run] == values[at]:
            run += 1
        if run >= 4:
            copy(at)
            out.extend((128 + run, values[at]))
            copy_from = at + run
        at += run
    copy(len(values))
    return bytes(out)


def hdr(place):
    out = bytearray(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode())
    for row in range(HEIGHT):
        pixels = [rgbe(pixel(place, column, row)) for column in range(WIDTH)]
        out.extend((2, 2, WIDTH >> 8, WIDTH & 255))
        for channel in range(4):
            out.extend(packed([p[channel] for p in pixels]))
    return bytes(out)


def write(path, data):
    """All of the file or nothing."""
    part = f"{path}.part"
    try:
        with open(part, "wb") as file:
            file.write(data)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.strip(), file=sys.stdout if arguments in (["-h"], ["--help"]) else sys.stderr)
        return 0 if arguments in (["-h"], ["--help"]) else 2
    folder = arguments[0]
    try:
        os.makedirs(folder, exist_ok=True)
        for name, place in (
            ("operating-theatre", operating_theatre()),
            ("photo-studio", photo_studio()),
            ("window", window()),
        ):
            write(os.path.join(folder, f"{name}.hdr"), hdr(place))
    except OSError as error:
        print(f"panoramas: {error.filename or folder}: {error.strerror}; choose another folder", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
