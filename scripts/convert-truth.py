#!/usr/bin/env python3
"""Converts the disparities of a published stereo pair to disp_left.pfm, nonocc.png and meta.json.

    convert-truth.py TRUTH SCENE_FOLDER KEY=VALUE...

TRUTH is an .npz with one array of float32, or an 8-bit grey .png whose values are disparities in pixels, 0 for unknown.
KEY=VALUE goes into meta.json; VALUE is JSON, or else text. scale_factor=N: the values in TRUTH are N times the
disparities, as for Middlebury's pictures of a third (3) or half (2) of the size. Needs only Python's standard library.
"""

import array
import json
import math
import pathlib
import struct
import sys
import zipfile
import zlib


def read_npz(path):
    """The rows of the only array in an .npz (numpy.lib.format, version 1.0), infinity for unknown."""
    with zipfile.ZipFile(path) as archive:
        (name,) = archive.namelist()
        data = archive.read(name)
    if data[:8] != b"\x93NUMPY\x01\x00":
        raise ValueError(f"{path}: {name} is not a .npy file of version 1.0")
    (length,) = struct.unpack_from("<H", data, 8)
    header = data[10 : 10 + length].decode("latin1")
    if "'descr': '<f4'" not in header or "'fortran_order': False" not in header:
        raise ValueError(f"{path}: expected float32 rows, found {header.strip()}")
    height, width = (int(n) for n in header.split("'shape': (")[1].split(")")[0].split(","))
    values = array.array("f", data[10 + length :])
    if sys.byteorder == "big":
        values.byteswap()
    return [[v if math.isfinite(v) else math.inf for v in values[y * width :][:width]] for y in range(height)]


def read_grey_png(path):
    """The rows of an 8-bit grey PNG, infinity for 0 (PNG specification, sections 5, 7 and 9)."""
    data = path.read_bytes()
    chunks, at = {}, 8
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        kind = data[at + 4 : at + 8]
        chunks[kind] = chunks.get(kind, b"") + data[at + 8 : at + 8 + length]
        at += 12 + length
    width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    if (depth, colour, interlaced) != (8, 0, 0):
        raise ValueError(f"{path}: expected an 8-bit grey picture without interlacing")
    packed, above, rows = zlib.decompress(chunks[b"IDAT"]), bytearray(width), []
    for y in range(height):
        start = y * (width + 1)
        method, row = packed[start], bytearray(packed[start + 1 : start + 1 + width])
        for x in range(width):
            left, up, corner = (row[x - 1] if x else 0), above[x], (above[x - 1] if x else 0)
            if method == 4:
                distances = [abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)]
                guess = (left, up, corner)[distances.index(min(distances))]
            else:
                guess = (0, left, up, (left + up) // 2)[method]
            row[x] = (row[x] + guess) & 255
        rows.append([float(v) if v else math.inf for v in row])
        above = row
    return rows


def write_pfm(path, rows):
    """Writes a grey PFM: little-endian, the bottom row first."""
    with path.open("wb") as file:
        file.write(f"Pf\n{len(rows[0])} {len(rows)}\n-1.0\n".encode())
        for row in reversed(rows):
            file.write(struct.pack(f"<{len(row)}f", *row))


def write_grey_png(path, rows):
    """Writes an 8-bit grey PNG."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def visible(row):
    """The non-occlusion mask of a row: 255 for a pixel that no pixel nearer by more than 1 px covers in the right view."""
    nearest = {}
    for x, disparity in enumerate(row):
        if disparity != math.inf:
            there = math.floor(x - disparity + 0.5)
            nearest[there] = max(nearest.get(there, 0.0), disparity)

    def seen(x, disparity):
        if disparity == math.inf:
            return False
        there = math.floor(x - disparity + 0.5)
        return there >= 0 and nearest[there] <= disparity + 1.0

    return [255 if seen(x, disparity) else 0 for x, disparity in enumerate(row)]


def main():
    truth, folder = (pathlib.Path(argument) for argument in sys.argv[1:3])
    rows = read_npz(truth) if truth.suffix == ".npz" else read_grey_png(truth)
    meta = {"scene": folder.name}
    for pair in sys.argv[3:]:
        key, value = pair.split("=", 1)
        try:
            meta[key] = json.loads(value)
        except json.JSONDecodeError:
            meta[key] = value
    factor = meta.get("scale_factor", 1)
    if not isinstance(factor, (int, float)) or factor <= 0:
        sys.exit(f"convert-truth: scale_factor is {factor}, but it must be a number above 0")
    rows = [[value / factor for value in row] for row in rows]
    known = [v for row in rows for v in row if v != math.inf]
    mask = [visible(row) for row in rows]
    meta |= {
        "nonocc": "computed from the left truth alone",
        "width": len(rows[0]),
        "height": len(rows),
        "min_disparity": round(min(known), 3),
        "max_disparity": round(max(known), 3),
        "valid_fraction": round(len(known) / (len(rows) * len(rows[0])), 4),
    }
    write_pfm(folder / "disp_left.pfm", rows)
    write_grey_png(folder / "nonocc.png", mask)
    (folder / "meta.json").write_text(json.dumps(meta, indent=1) + "\n")


if __name__ == "__main__":
    main()
