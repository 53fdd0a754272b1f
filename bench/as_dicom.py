#!/usr/bin/env python3
"""A volume (NRRD, raw or gzip) as a DICOM series of CT slices, one patient's, for tests and measurements.

  as_dicom.py VOLUME.nrrd FOLDER [--patient NAME] [--id ID] [--number N] [--hu SCALE,OFFSET]

The same volume and options give the same bytes: UIDs follow from the number. Needs numpy."""
import argparse
import gzip
import pathlib
import struct

import numpy

KINDS = {"uchar": "u1", "uint8": "u1", "unsigned char": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2",
         "float": "<f4"}
LONG = {b"OB", b"OW", b"SQ", b"UN", b"UT"}
ROOT = "1.2.826.0.1.3680043.2.1125.77"


def read_nrrd(path):
    """Voxels [z, y, x], the lengths of their sides, mm, and whether x and y go to the right and the front."""
    head, _, body = pathlib.Path(path).read_bytes().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    if fields["encoding"] in ("gzip", "gz"):
        body = gzip.decompress(body)
    sizes = [int(n) for n in fields["sizes"].split()]
    voxels = numpy.frombuffer(body, KINDS[fields["type"]], count=sizes[0] * sizes[1] * sizes[2]).reshape(sizes[::-1])
    if "space directions" in fields:
        axes = [tuple(float(n) for n in axis.strip("()").split(",")) for axis in fields["space directions"].split()]
        spacing = [sum(n * n for n in axis) ** 0.5 for axis in axes]
    else:
        spacing = [float(n) for n in fields["spacings"].split()]
    return voxels, spacing, fields.get("space", "").startswith("right-anterior")


def element(group, number, vr, value):
    if isinstance(value, str):
        value = value.encode()
    if len(value) % 2:
        value += b"\0" if vr in (b"UI", b"OB") else b" "
    size = struct.pack("<HI", 0, len(value)) if vr in LONG else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr + size + value


def us(number):
    return struct.pack("<H", number)


def dicom_file(slice_, index, spacing, sign, options):
    series = f"{ROOT}.{options.number}"
    instance = f"{series}.{index + 1}"
    ct = "1.2.840.10008.5.1.4.1.1.2"
    meta = b"".join([element(2, 1, b"OB", b"\0\1"), element(2, 2, b"UI", ct), element(2, 3, b"UI", instance),
                     element(2, 0x10, b"UI", "1.2.840.10008.1.2.1"), element(2, 0x12, b"UI", ROOT)])
    rows, columns = slice_.shape
    place = f"{-sign * spacing[0] * columns / 2:.4f}\\{-sign * spacing[1] * rows / 2:.4f}\\{spacing[2] * index:.4f}"
    body = b"".join([
        element(8, 5, b"CS", "ISO_IR 192"), element(8, 8, b"CS", "ORIGINAL\\PRIMARY\\AXIAL"),
        element(8, 0x16, b"UI", ct), element(8, 0x18, b"UI", instance), element(8, 0x20, b"DA", "20270101"),
        element(8, 0x30, b"TM", "120000"),
        element(8, 0x50, b"SH", f"A{options.number}"), element(8, 0x60, b"CS", "CT"), element(8, 0x90, b"PN", ""),
        element(8, 0x103e, b"LO", "measured"), element(0x10, 0x10, b"PN", options.patient),
        element(0x10, 0x20, b"LO", options.id), element(0x10, 0x30, b"DA", "19010203"), element(0x10, 0x40, b"CS", "O"),
        element(0x18, 0x50, b"DS", f"{spacing[2]:.4f}"), element(0x20, 0xd, b"UI", f"{series}.0"),
        element(0x20, 0xe, b"UI", series), element(0x20, 0x10, b"SH", "1"), element(0x20, 0x11, b"IS", "1"),
        element(0x20, 0x13, b"IS", f"{index + 1}"), element(0x20, 0x32, b"DS", place),
        element(0x20, 0x37, b"DS", f"{sign}\\0\\0\\0\\{sign}\\0"), element(0x28, 2, b"US", us(1)),
        element(0x28, 4, b"CS", "MONOCHROME2"), element(0x28, 0x10, b"US", us(rows)),
        element(0x28, 0x11, b"US", us(columns)), element(0x28, 0x30, b"DS", f"{spacing[1]:.5f}\\{spacing[0]:.5f}"),
        element(0x28, 0x100, b"US", us(16)), element(0x28, 0x101, b"US", us(16)), element(0x28, 0x102, b"US", us(15)),
        element(0x28, 0x103, b"US", us(1)), element(0x28, 0x1052, b"DS", "0"), element(0x28, 0x1053, b"DS", "1"),
        element(0x7fe0, 0x10, b"OW", slice_.astype("<i2").tobytes())])
    return b"\0" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + body


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("volume")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--patient", default="Planted^Zqx7")
    parser.add_argument("--id", default="zqx7-1")
    parser.add_argument("--number", type=int, default=1, help="of the series")
    parser.add_argument("--hu", default="1,0")
    options = parser.parse_args()
    scale, offset = (float(n) for n in options.hu.split(","))
    voxels, spacing, to_right = read_nrrd(options.volume)
    options.folder.mkdir(parents=True)
    for index, slice_ in enumerate(voxels):
        hu = numpy.clip(numpy.rint(slice_ * scale + offset), -32768, 32767)
        name = options.folder / f"{index:05}.dcm"
        name.write_bytes(dicom_file(hu, index, spacing, -1 if to_right else 1, options))


if __name__ == "__main__":
    main()
