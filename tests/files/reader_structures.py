"""Damage that keeps a file's structure: checksums fit, brackets close, and what the structure says is absurd.

Damaged bytes mostly end at a reader's first check. What these make gets past it: counts without content, content
without end, archives that unpack to gigabytes, texts nested without bottom.
"""

from __future__ import annotations

import gzip
import io
import json
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable
from functools import cache

COUNTS = [-(2**63), -(2**31), -32768, -3, -1, 0, 1, 2, 7, 255, 256, 32767, 65535, 2**24, 2**31 - 1, 2**31, 2**32 - 1,
          2**40, 2**63 - 1, 10**30]  # fmt: skip
"""What no count should be."""

DEPTHS = (60, 1000, 20_000)

BOMB = 3 * 2**30
"""Bytes that a bomb unpacks to."""

Draw = random.Random
Damage = Callable[[bytes, Draw], bytes]


@cache
def zeros_deflated(wbits: int = zlib.MAX_WBITS) -> bytes:
    """Return three gigabytes of zeros, deflated."""
    engine, block = zlib.compressobj(9, zlib.DEFLATED, wbits), bytes(2**24)
    return b"".join([*(engine.compress(block) for _ in range(BOMB // len(block))), engine.flush()])


# -- JSON -------------------------------------------------------------------------------------------------------------


def odd_json(draw: Draw) -> str:
    """Return a piece of JSON that should not be where it is put."""
    depth = draw.choice(DEPTHS)
    return draw.choice([
        "null", "true", "[]", "{}", '""', "-0", "1e999", "-1e308", "NaN", "-Infinity", "1e-320", "0.1",
        str(draw.choice(COUNTS)), "9" * 5000, json.dumps("x" * 10**5), '"\\u0000\\ud800"', '"../../../etc/passwd"',
        json.dumps("a\nb\u2028"), "[" * depth + "]" * depth, '{"a":' * depth + "1" + "}" * depth,
        json.dumps([[k, k * k % 7] for k in range(2000)]), json.dumps([[0, 0]] * 1000),
        "[[0,0],[1,1],[1,0],[0,1],[0,0]]",
    ])  # fmt: skip


def damaged_json(data: bytes, draw: Draw) -> bytes:
    """Change, drop, double or move a value of a JSON text, wherever it is."""
    try:
        tree = json.loads(data)
    except ValueError:
        return data
    places = [(holder, key) for holder in _holders(tree) for key in _keys(holder)]
    if not places:
        return odd_json(draw).encode()
    for _ in range(draw.choice((1, 1, 2, 3))):
        holder, key = draw.choice(places)
        if key not in _keys(holder):  # gone by the damage before
            continue
        how = draw.random()
        if how < 0.6:
            holder[key] = "\x01odd"
        elif how < 0.75:
            holder.pop(key)
        elif how < 0.9:
            other, at = draw.choice(places)
            if at in _keys(other):
                holder[key] = json.loads(json.dumps(other[at]))
        elif isinstance(holder, dict):
            holder["surplus"] = "\x01odd"
        else:
            holder.extend(holder[:500])
    try:
        text = json.dumps(tree)
    except (ValueError, RecursionError):
        return data
    while json.dumps("\x01odd") in text:
        text = text.replace(json.dumps("\x01odd"), odd_json(draw), 1)
    return text.encode("utf-8", "surrogatepass")


def _holders(tree: object) -> list[dict | list]:
    found, left = [], [tree]
    while left:
        value = left.pop()
        if isinstance(value, dict | list):
            found.append(value)
            left.extend(value.values() if isinstance(value, dict) else value)
    return found


def _keys(holder: dict | list) -> list:
    return list(holder) if isinstance(holder, dict) else list(range(len(holder)))


# -- zip archives: studies, .npz --------------------------------------------------------------------------------------


def damaged_zip(data: bytes, draw: Draw) -> bytes:
    """Damage what a zip archive holds, or what it says that it holds."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    how = draw.choice(["member", "member", "member", "bomb", "many", "names", "says", "nested"])
    name = draw.choice(sorted(content))
    if how == "member":
        inner = damaged_json if name.endswith(".json") else damaged_npy
        return zipped({**content, name: inner(content[name], draw)})
    if how == "many":
        return zipped({**content, **{f"arrays/a{k}.npy": b"" for k in range(1500)}})
    if how == "names":
        odd = draw.choice(["../x.npy", "/etc/x", "arrays/../study.json", "a" * 5000, "\x00", "x/" * 500, "C:\\x", ""])
        return zipped({odd if other == name else other: body for other, body in content.items()})
    if how == "nested":
        return zipped({**content, name: data})
    if how == "bomb":
        return with_bomb(content, name)
    damaged = bytearray(zipped(content))
    directory = damaged.rfind(b"PK\x01\x02")
    field = draw.choice([8, 10, 20, 24, 28, 42])  # flags, method, packed size, size, length of the name, place
    struct.pack_into(
        "<I" if field in (20, 24, 42) else "<H", damaged, directory + field, draw.choice([1, 9, 0x7FFF, 99])
    )
    return bytes(damaged)


def zipped(content: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, body in content.items():
            archive.writestr(zipfile.ZipInfo(name), body, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def with_bomb(content: dict[str, bytes], name: str) -> bytes:
    """Return an archive one member of which says that it is small, and unpacks to gigabytes."""
    packed, names, body, directory = zeros_deflated(-zlib.MAX_WBITS), list(content), b"", b""
    for member in names:
        raw = content[member]
        engine = zlib.compressobj(6, zlib.DEFLATED, -zlib.MAX_WBITS)
        stored = packed if member == name else engine.compress(raw) + engine.flush()
        sizes = struct.pack("<IIIHH", zlib.crc32(raw), len(stored), len(raw), len(member.encode()), 0)
        at = len(body)
        body += b"PK\x03\x04" + struct.pack("<HHHHH", 20, 0, 8, 0, 33) + sizes + member.encode() + stored
        directory += b"PK\x01\x02" + struct.pack("<HHHHHH", 20, 20, 0, 8, 0, 33) + sizes
        directory += struct.pack("<HHHII", 0, 0, 0, 0, at) + member.encode()
    end = struct.pack("<HHHHIIH", 0, 0, len(names), len(names), len(directory), len(body), 0)
    return body + directory + b"PK\x05\x06" + end


# -- NumPy ------------------------------------------------------------------------------------------------------------


def damaged_npy(data: bytes, draw: Draw) -> bytes:
    """Write another header over an array's content."""
    big = draw.choice(COUNTS)
    shape = draw.choice([f"({big},)", f"({big}, 2)", "()", "(0,)", "(0, 5)", f"({2**20}, {2**20})", "(3, 4, 5)",
                         "(-1, -3)", "(1.5,)", "'x'", "(" * 300 + ")" * 300, f"({'1, ' * 70})"])  # fmt: skip
    kind = draw.choice(["'<f8'", "'<f8'", "'<f8'", "'>i2'", "'|O'", "'<M8[s]'", "'<c16'", "'|V8'", "'|S0'", "'<U9'",
                        "[('a', '<f8'), ('b', '|O')]", "'<f" + "8" * 50 + "'", "None"])  # fmt: skip
    order = draw.choice(["True", "False", "2", "None"])
    header = f"{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}"
    version = draw.choice([(1, 0), (1, 0), (2, 0), (3, 0), (9, 9)])
    text = header.encode() + b" " * draw.choice([0, 10, 60_000]) + b"\n"
    length = struct.pack("<H" if version == (1, 0) else "<I", min(len(text), 65535))
    return b"\x93NUMPY" + bytes(version) + length + text + data[-64 * draw.choice([0, 1, 1, 4]) :]


# -- compressed and medical -------------------------------------------------------------------------------------------


def damaged_nifti(data: bytes, draw: Draw) -> bytes:
    """Change fields of a NIfTI header."""
    damaged = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 4))):
        at, code = draw.choice([(0, "<i"), *[(40 + 2 * k, "<h") for k in range(8)], (70, "<h"), (72, "<h"),
                                *[(76 + 4 * k, "<f") for k in range(8)], (108, "<f"), (112, "<f"), (116, "<f"),
                                (123, "<b"), (252, "<h"), (254, "<h"), (344, "<i")])  # fmt: skip
        if len(damaged) >= at + 4:
            if code == "<f":
                value = draw.choice([0.0, -1.0, 1e38, -1e38, 1e-40, float("nan"), float("inf")])
            else:
                top = 2 ** (8 * struct.calcsize(code) - 1)
                value = draw.choice([number for number in COUNTS if -top <= number < top])
            struct.pack_into(code, damaged, at, value)
    return bytes(damaged)


def damaged_gzip(data: bytes, draw: Draw) -> bytes:
    """Damage what is packed, or pack it oddly: cut, doubled, or followed by gigabytes."""
    inner = damaged_nifti(gzip.decompress(data), draw)
    whole = gzip.compress(inner, mtime=0)
    return draw.choice([
        lambda: whole, lambda: whole[: draw.randrange(len(whole))], lambda: whole + whole,
        lambda: whole + b"junk", lambda: gzip.compress(whole),
        lambda: zeros_deflated(31), lambda: whole + zeros_deflated(31), lambda: gzip_bomb(inner),
    ])()  # fmt: skip


def gzip_bomb(start: bytes) -> bytes:
    """Return what unpacks to a sound start and then to gigabytes."""
    engine = zlib.compressobj(0, zlib.DEFLATED, 31)
    stored = engine.compress(start) + engine.flush(zlib.Z_FULL_FLUSH)
    return stored + zeros_deflated(-zlib.MAX_WBITS)


def damaged_dicom(data: bytes, draw: Draw) -> bytes:
    """Set an element of a DICOM file to what it cannot be, or nest sequences in it."""
    rows, columns, frames = b"\x28\x00\x10\x00", b"\x28\x00\x11\x00", b"\x28\x00\x08\x00"
    allocated, stored, samples, sign = (bytes([0x28, 0, k, n]) for k, n in ((0, 1), (1, 1), (2, 0), (3, 1)))
    tag = draw.choice(
        [rows, columns, frames, allocated, stored, samples, sign, b"\x28\x00\x30\x00", b"\xe0\x7f\x10\x00"]
    )
    at = data.find(tag, 132)
    if draw.random() < 0.15:
        deep = draw.choice(DEPTHS)
        sequence = b"\x08\x00\x40\x11SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff" * deep
        return data[:at] + sequence + data[at:] if at > 0 else data + sequence
    if at < 0:
        return data
    damaged = bytearray(data)
    if draw.random() < 0.4:
        struct.pack_into("<H", damaged, at + 6, draw.choice([0, 1, 3, 0x7FFF, 0xFFFF]))  # the length
    else:
        value = damaged[at + 6] | damaged[at + 7] << 8
        damaged[at + 8 : at + 8 + value] = draw.choice([b"\0", b"\xff", b"9", b"-", b"1e9\\"]) * value
    return bytes(damaged[: len(data) + 100])


# -- pictures ---------------------------------------------------------------------------------------------------------


def damaged_png(data: bytes, draw: Draw) -> bytes:
    """Change, add or drop chunks of a PNG, each with its right checksum."""
    chunks, at = [], 8
    while at + 12 <= len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        chunks.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    how = draw.choice(["size", "size", "depth", "text", "bomb", "order", "drop", "again", "empty"])
    kind, body = chunks[0]
    if how == "size":
        wide, high = (draw.choice([0, 1, 7, 65535, 2**20, 2**31 - 1, 2**32 - 1]) for _ in range(2))
        chunks[0] = kind, struct.pack(">II", wide, high) + body[8:]
    elif how == "depth":
        chunks[0] = kind, body[:8] + bytes(draw.choice([0, 1, 2, 3, 4, 6, 8, 16, 99]) for _ in range(5))
    elif how == "text":
        odd = draw.choice([b"tEXta\0" + b"x" * 10**5, b"zTXta\0\0" + zeros_deflated(), b"iCCPa\0\0" + zeros_deflated(),
                           b"iTXta\0\1\0\0\0" + zeros_deflated(), b"eXIfII*\0\xff\xff\xff\xff"])  # fmt: skip
        chunks.insert(1, (odd[:4], odd[4:]))
    elif how == "bomb":
        side = draw.choice([9, 6000, 50_000])
        chunks[0] = kind, struct.pack(">II", side, side) + body[8:]
        chunks[1:] = [(b"IDAT", zeros_deflated()), (b"IEND", b"")]
    elif how == "order":
        draw.shuffle(chunks)
    elif how == "drop":
        chunks.pop(draw.randrange(len(chunks)))
    elif how == "again":
        chunks.insert(draw.randrange(len(chunks)), draw.choice(chunks))
    else:
        chunks = [(name, b"" if name == b"IDAT" else held) for name, held in chunks]
    return data[:8] + b"".join(
        struct.pack(">I", len(held)) + name + held + struct.pack(">I", zlib.crc32(name + held)) for name, held in chunks
    )


def damaged_jpeg(data: bytes, draw: Draw) -> bytes:
    """Change a JPEG's size, precision, number of channels or tables."""
    damaged = bytearray(data)
    marker = draw.choice([b"\xff\xc0", b"\xff\xc0", b"\xff\xda", b"\xff\xdb", b"\xff\xc4", b"\xff\xe0"])
    at = data.find(marker)
    if at < 0 or at + 12 > len(data):
        return data
    part = draw.choice([2, 4, 5, 7, 9])
    struct.pack_into(">H", damaged, at + part, draw.choice([0, 1, 2, 255, 32767, 65500, 65535]))
    return bytes(damaged)


def damaged_tiff(data: bytes, draw: Draw) -> bytes:
    """Change entries of a TIFF's directory."""
    damaged = bytearray(data)
    directory = int.from_bytes(data[4:8], "little")
    count = int.from_bytes(data[directory : directory + 2], "little")
    for _ in range(draw.choice((1, 1, 2))):
        entry = directory + 2 + 12 * draw.randrange(max(1, min(count, 30)))
        part, code = draw.choice([(0, "<H"), (2, "<H"), (4, "<I"), (8, "<I"), (8, "<I"), (8, "<I")])
        if entry + 12 <= len(damaged):
            top = 2 ** (8 * struct.calcsize(code))
            struct.pack_into(code, damaged, entry + part, draw.choice([n for n in COUNTS if 0 <= n < top]))
    if draw.random() < 0.2:  # a directory that follows itself
        struct.pack_into("<I", damaged, min(directory + 2 + 12 * count, len(damaged) - 4), directory)
    return bytes(damaged)


# -- XML: VTK's family and SVG ----------------------------------------------------------------------------------------

ATTRIBUTE = re.compile(rb'([\w:]+)="([^"]*)"')
LAUGHS = (
    b'<!DOCTYPE d [<!ENTITY a "ha">'
    + b"".join(b'<!ENTITY %c "%s">' % (98 + k, b"&%c;" % (97 + k) * 10) for k in range(9))
    + b"]>"
)
OUTSIDE = b'<!DOCTYPE d [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


def damaged_xml(data: bytes, draw: Draw) -> bytes:
    """Change attributes of an XML text, nest it without bottom, or have it laugh."""
    how = draw.random()
    start = data.find(b"?>") + 2 if data.startswith(b"<?xml") else 0
    if how < 0.1:
        doctype = draw.choice([LAUGHS, OUTSIDE])
        return data[:start] + doctype + data[start:].replace(b">", b">&j;" if doctype is LAUGHS else b">&a;", 1)
    if how < 0.2:
        depth, name = draw.choice(DEPTHS), draw.choice([b"g", b"Piece", b"DataArray", b"svg"])
        middle = draw.randrange(start, len(data))
        at = data.find(b">", middle) + 1
        return data[:at] + b"<%s>" % name * depth + b"</%s>" % name * depth + data[at:]
    found = list(ATTRIBUTE.finditer(data[:20_000]))
    if not found:
        return data
    for match in sorted(draw.sample(found, min(len(found), draw.choice((1, 1, 2)))), key=lambda m: -m.start()):
        value = draw.choice([
            str(draw.choice(COUNTS)).encode(), b"", b"nan", b"1e999", b"x" * 10**5, b"0 " * 10**4, b"Float64", b"ascii",
            b"Int8", b"0 4 0 3 0 0", b"0 99999 0 99999 0 99999", b"scale(1e300)", b"matrix(" + b"1," * 10**4 + b"1)",
            b"M0,0" + b"a1,1 0 1 1 1,0" * 3000, b"M0,0 " + b"c1e9,0 0,1e9 1,1" * 500, b"rotate(" * 5000,
            b"&#0;", b"url(#x)",
        ])  # fmt: skip
        data = data[: match.start(2)] + value + data[match.end(2) :]
    return data


# -- texts of numbers, formulas ---------------------------------------------------------------------------------------


def damaged_numbers(data: bytes, draw: Draw) -> bytes:
    """Change the counts of a text of numbers, or repeat its rows by the ten thousand."""
    lines = data.split(b"\n")
    if draw.random() < 0.7:
        short = [k for k, line in enumerate(lines) if re.fullmatch(rb"[\w ]*\d[\w ]*", line.strip()) and len(line) < 40]
        if short:
            k = draw.choice(short)
            lines[k] = re.sub(
                rb"\d+", lambda _: str(draw.choice(COUNTS)).encode(), lines[k], count=draw.choice((1, 1, 0))
            )
        return b"\n".join(lines)
    k = draw.randrange(len(lines))
    return b"\n".join([*lines[:k], *[lines[k][:200]] * draw.choice((2, 50, 20_000)), *lines[k:]])


def odd_formula(text: bytes, draw: Draw) -> bytes:
    """Return a formula that nests, chains or grows without bound, or that means to be more than a formula."""
    depth = draw.choice((50, 99, 101, 1000))
    return draw.choice([
        b"(" * depth + text + b")" * depth, b"-" * depth + b"x", b"abs(" * depth + b"x" + b")" * depth,
        b"**".join([b"9"] * depth), b"+".join([text] * 40)[:5000], b"max(" + b",".join([b"x"] * 2000) + b")",
        b"().__class__.__bases__", b"__import__('os').system('x')", b"x.real", b"x if y else 1", b"lambda: x", b"x;y",
        b"1e999", b"9" * 4000, b"1/0*x", b"log(-x)", b"x\xc2\xb2", "ｘ+１".encode(), b"0x1F", b"1_000", b"x==y",
        b"min()", b"max(", b"hypot(x)", b"atan2(x,y,1)", b"x y", b"2x", b"\0", b" " * 4999 + b"x", b"", b"pi(2)",
        b"x**-x**-x",
    ])  # fmt: skip


STRUCTURAL: dict[str, Damage] = {
    ".sizeviz": damaged_zip,
    ".npz": damaged_zip,
    ".npy": damaged_npy,
    ".geojson": damaged_json,
    ".json": damaged_json,
    ".nii": damaged_nifti,
    ".nii.gz": damaged_gzip,
    ".dcm": damaged_dicom,
    ".png": damaged_png,
    ".tif": damaged_tiff,
    ".jpg": damaged_jpeg,
    **dict.fromkeys((".vtu", ".vtp", ".vti", ".svg"), damaged_xml),
    **dict.fromkeys((".vtk", ".msh", ".pos", ".mesh", ".sol", ".csv", ".txt"), damaged_numbers),
    "formula": odd_formula,
}
"""What damages the structure of each kind of file."""
