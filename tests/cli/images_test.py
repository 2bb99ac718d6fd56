# SPDX-License-Identifier: Apache-2.0
"""Textures of every format as bitspan, Pillow and ImageMagick read them, beside what the format's description says.

The pictures are written here, byte by byte where no library writes such a file. Each is in one of three groups: both
libraries read it, or those that `by` names do. bitspan must give the texels of the description and those of each reader."""

import io
import itertools
import json
import os
import pathlib
import random
import struct
import subprocess
import tempfile
import unittest

from PIL import Image

PROGRAM = os.environ["BITSPAN_PROGRAM"]
MAGICK = "/usr/bin/convert-im6.q16"
dice = random.Random(23)


def scaled(value, maximum):
    """As one of 0..255, rounded to nearest."""
    return (2 * value * 255 + maximum) // (2 * maximum)


def row_bytes(codes, bits, unit):
    """Codes of less than 8 bits, the first in the top bits, filled to a whole number of `unit` bytes."""
    value, size = 0, (len(codes) * bits + 8 * unit - 1) // (8 * unit) * unit
    for code in codes:
        value = value << bits | code
    return (value << (8 * size - bits * len(codes))).to_bytes(size, "big")


def padded(data, unit):
    return data + bytes(-len(data) % unit)


def codes(width, height, count):
    return [[dice.randrange(count) for _ in range(width)] for _ in range(height)]


def palette(count):
    return [tuple(dice.randrange(256) for _ in range(3)) for _ in range(count)]


def opaque(rows):
    return [[(*texel[:3], 255) for texel in row] for row in rows]


class Case:
    """A file, its texels row by row from the top, and the readers that read it. `near`: how far they may be."""

    def __init__(self, name, data, rows, by=("pillow", "magick"), near=0):
        self.name, self.data, self.rows, self.by, self.near = name, bytes(data), rows, by, near


# ---- BMP


def bmp(rows, bits, colors=None, header=40, compression=0, masks=b"", count=None, top_down=False, data=None):
    """`rows`: codes, from the top. `colors`: the palette."""
    height, width = len(rows), len(rows[0])
    entry = 3 if header == 12 else 4
    table = b"".join(bytes([b, g, r]) + bytes(entry - 3) for r, g, b in colors or [])
    if header == 12:
        info = struct.pack("<IHHHH", 12, width, height, 1, bits)
    else:
        used = len(colors) if count is None and colors else count or 0
        info = struct.pack("<IiiHHIIiiII", header, width, -height if top_down else height, 1, bits, compression,
                           0, 2835, 2835, used, 0) + masks
    info += bytes(max(0, header - len(info)))
    if data is None:
        order = rows if top_down else rows[::-1]
        if bits <= 8:
            data = b"".join(row_bytes(row, bits, 4) for row in order)
        else:
            data = b"".join(padded(b"".join(code.to_bytes(bits // 8, "little") for code in row), 4) for row in order)
    at = 14 + len(info) + len(table)
    return struct.pack("<2sIHHI", b"BM", at + len(data), 0, 0, at) + info + table + data


def of_palette(rows, colors):
    return [[(*colors[c], 255) if c < len(colors) else (0, 0, 0, 255) for c in row] for row in rows]


def of_masks(rows, masks):
    def channel(value, mask, otherwise):
        if mask == 0:
            return otherwise
        shift = (mask & -mask).bit_length() - 1
        return scaled((value & mask) >> shift, mask >> shift)
    return [[tuple(channel(c, mask, 255 if k == 3 else 0) for k, mask in enumerate(masks)) for c in row] for row in rows]


def run_rows(width, height, count):
    """Rows of runs, of codes one by one, of pairs that alternate, and of index 0; the second row is 0 alone."""
    rows = []
    for y in range(height):
        row = [0] * width if y == 1 else []
        while len(row) < width:
            some = [dice.randrange(1, count) for _ in range(dice.randrange(3, 9))]
            row += dice.choice([some, some[:1] * len(some), some[:2] * 4, [0] * len(some)])
        rows.append(row[:width])
    return rows


def rle(rows, bits):
    """Run lengths of all kinds, bottom row first; deltas over what is 0."""
    out, up = bytearray(), 0
    for row in rows[::-1]:
        if not any(row):
            up += 1
            continue
        if up:
            out += bytes([0, 2, 0, up])
            up = 0
        x = 0
        while x < len(row):
            same = len(list(itertools.takewhile(lambda c: c == row[x], row[x:])))
            pairs = len(list(itertools.takewhile(lambda k: row[k] == row[x + (k - x) % 2], range(x, len(row)))))
            literal = min(dice.randrange(3, 9), len(row) - x)
            if row[x] == 0 and same > 2:
                out += bytes([0, 2, same, 0])
            elif bits == 4 and pairs > 3:
                same = pairs
                out += bytes([same, row[x] << 4 | row[x + 1]])
            elif same > 2 or literal < 3:
                out += bytes([same, row[x] * 17 if bits == 4 else row[x]])
            else:
                same = literal
                out += bytes([0, same]) + padded(row_bytes(row[x:x + same], bits, 1), 2)
            x += same
        out += b"\0\0"
    return bytes(out + b"\0\1")


def bmps():
    for bits, width, height in itertools.product((1, 2, 4, 8), (1, 7, 32, 33), (1, 5)):
        colors, rows = palette(1 << bits), codes(width, height, 1 << bits)
        # Pillow reads no 2 bits.
        by = ("pillow", "magick") if bits != 2 else ()
        for top_down in False, True:
            yield Case(f"{bits}-{width}x{height}-{top_down}", bmp(rows, bits, colors, top_down=top_down), of_palette(rows, colors), by)
        for header in (12, 64, 108, 124):
            yield Case(f"{bits}-{width}x{height}-h{header}", bmp(rows, bits, colors, header=header), of_palette(rows, colors),
                       by if header != 64 else by[:1])
    for count in 1, 3, 200:
        colors, rows = palette(count), codes(21, 3, count)
        yield Case(f"short-{count}", bmp(rows, 8, colors), of_palette(rows, colors))
        beyond = codes(21, 3, 256)
        yield Case(f"beyond-{count}", bmp(beyond, 8, colors), of_palette(beyond, colors), by=())
        yield Case(f"core-{count}", bmp(rows, 8, colors, header=12), of_palette(rows, colors), by=("pillow",))
    for width, height in (1, 3), (2, 2), (5, 4), (16, 1):
        colors = [[dice.randrange(1 << 24) for _ in range(width)] for _ in range(height)]
        masks = 0xff0000, 0xff00, 0xff, 0
        for top_down in False, True:
            yield Case(f"24-{width}-{top_down}", bmp(colors, 24, top_down=top_down), of_masks(colors, masks))
        yield Case(f"24-{width}-core", bmp(colors, 24, header=12), of_masks(colors, masks))
        wide = [[c | dice.randrange(256) << 24 for c in row] for row in colors]
        # ImageMagick takes the fourth byte for alpha where nothing says so.
        yield Case(f"32-{width}", bmp(wide, 32), of_masks(wide, masks), by=("pillow",))
        for header in 108, 124:
            # The masks of a header count with the compression that says so alone.
            yield Case(f"32-{width}-h{header}", bmp(wide, 32, header=header, masks=struct.pack("<4I", 1, 2, 4, 8)), of_masks(wide, masks),
                       by=("pillow",))
        half = codes(width, height, 1 << 16)
        yield Case(f"16-{width}", bmp(half, 16), of_masks(half, (0x7c00, 0x3e0, 0x1f, 0)), near=1)
        # Pillow takes only these masks.
        for masks in (0xf800, 0x7e0, 0x1f, 0), (0x7c00, 0x3e0, 0x1f, 0):
            yield Case(f"16-{width}-{masks[1]:x}", bmp(half, 16, compression=3, masks=struct.pack("<3I", *masks[:3])), of_masks(half, masks), near=1)
        for masks in (0xff, 0xff00, 0xff0000, 0xff000000), (0xff0000, 0xff00, 0xff, 0xff000000), (0xff000000, 0xff0000, 0xff00, 0xff):
            for header in 108, 124:
                yield Case(f"32-{width}-{masks[0]:x}-h{header}", bmp(wide, 32, header=header, compression=3, masks=struct.pack("<4I", *masks)),
                           of_masks(wide, masks), by=("pillow", "magick"))
        for masks in (0xff000000, 0xff0000, 0xff00, 0), (0x3ff00000, 0xffc00, 0x3ff, 0), (0xf00, 0xf0, 0xf, 0):
            # Pillow takes few masks, and ImageMagick scales no 4 bits.
            by = {0xff000000: ("pillow", "magick"), 0x3ff00000: ("magick",), 0xf00: ()}[masks[0]]
            yield Case(f"32-{width}-{masks[0]:x}", bmp(wide, 32, compression=3, masks=struct.pack("<3I", *masks[:3])), of_masks(wide, masks),
                       by=by, near=1)
            yield Case(f"32-{width}-{masks[0]:x}-v2", bmp(wide, 32, header=52, compression=3, masks=struct.pack("<3I", *masks[:3])),
                       of_masks(wide, masks), by=())
        masks = 0x3ff00000, 0xffc00, 0x3ff, 0xc0000000
        yield Case(f"32-{width}-v3", bmp(wide, 32, header=56, compression=3, masks=struct.pack("<4I", *masks)), of_masks(wide, masks), by=())
        masks = 0xf00, 0xf0, 0xf, 0xf000
        yield Case(f"16-{width}-v3", bmp(half, 16, header=56, compression=3, masks=struct.pack("<4I", *masks)), of_masks(half, masks), by=())
    for bits, (width, height) in itertools.product((4, 8), ((9, 5), (32, 4), (33, 7), (300, 9))):
        colors = palette(1 << bits)
        rows = run_rows(width, height, 1 << bits)
        # Pillow counts codes one by one wrongly where they are odd, and takes a delta for 128 bytes.
        yield Case(f"rle{bits}-{width}", bmp(rows, bits, colors, compression=3 - bits // 4, data=rle(rows, bits)), of_palette(rows, colors),
                   by=("magick",))
    for mode in "1", "L", "P", "RGB", "RGBA":
        yield of_pillow(f"written-{mode}", mode, "BMP", by=("pillow",) if mode == "RGBA" else ("pillow", "magick"))


def of_pillow(name, mode, form, by=("pillow", "magick"), **options):
    """A file that Pillow writes."""
    image = picture(mode)
    out = io.BytesIO()
    image.save(out, form, **options)
    # Pillow writes the alpha of a BMP, and no mask that says so.
    return Case(name, out.getvalue(), rows_of(image.convert("RGB" if form == "BMP" else "RGBA")), by)


def picture(mode, width=23, height=11):
    image = Image.frombytes("RGBA", (width, height), dice.randbytes(4 * width * height))
    if mode == "P":
        return image.convert("RGB").quantize(64)
    if mode == "I;16":
        return Image.frombytes("I;16", (width, height), dice.randbytes(2 * width * height))
    return image.convert(mode)


def rows_of(image):
    flat = list(image.convert("RGBA").getdata())
    return [flat[y * image.width:(y + 1) * image.width] for y in range(image.height)]


def rows_of_file(path):
    with Image.open(path) as image:
        return rows_of(image)


# ---- TGA


def tga(rows, kind, bits, descriptor=0, colors=None, first=0, color_bits=24, runs=False):
    """`rows`: bytes of texels, as the picture has them."""
    height, width = len(rows), len(rows[0])
    order = rows if descriptor & 32 else rows[::-1]
    order = [row[::-1] if descriptor & 16 else row for row in order]
    flat = [texel for row in order for texel in row]
    data = b"".join(flat)
    if runs:
        out, at = bytearray(), 0
        while at < len(flat):
            same = len(list(itertools.takewhile(lambda t: t == flat[at], flat[at:at + 128])))
            if same > 1:
                out += bytes([127 + same]) + flat[at]
                at += same
            else:
                some = flat[at:at + dice.randrange(1, 128)]
                out += bytes([len(some) - 1]) + b"".join(some)
                at += len(some)
        data = bytes(out)
    table = b"".join(colors or [])
    return struct.pack("<BBBHHBHHHHBB", 5, 1 if colors else 0, kind + (8 if runs else 0), first if colors else 0, len(colors or []),
                       color_bits if colors else 0, 0, 0, width, height, bits, descriptor) + b"ident" + table + data


def color_of(data, bits, alpha):
    if bits <= 16:
        value = int.from_bytes(data, "little")
        return (*(scaled(value >> shift & 31, 31) for shift in (10, 5, 0)), 0 if bits == 16 and alpha and value < 1 << 15 else 255)
    return (data[2], data[1], data[0], data[3] if bits == 32 and alpha else 255)


def tgas():
    for direction, runs, (width, height) in itertools.product((0, 0x10, 0x20, 0x30), (False, True), ((1, 1), (2, 1), (7, 3), (150, 2))):
        name, both = f"{direction:x}-{runs}-{width}", ("pillow", "magick")
        for bits, alpha in (15, 0), (16, 0), (16, 1), (24, 0), (32, 0), (32, 8):
            # Few colours, so that there are runs.
            some = [dice.randbytes((bits + 7) // 8) for _ in range(3)]
            rows = [[dice.choice(some) for _ in range(width)] for _ in range(height)]
            # Pillow knows no 15 bits and no alpha of 16; both take the fourth byte for alpha whatever the attribute bits say.
            by = {15: ("magick",), 16: both if alpha == 0 else ("magick",), 24: both, 32: both if alpha else ()}[bits]
            yield Case(f"{bits}-{alpha}-{name}", tga(rows, 2, bits, direction | alpha, runs=runs), [[color_of(c, bits, alpha) for c in row] for row in rows],
                       by=by, near=0 if bits > 16 else 1)
            colors = [dice.randbytes((bits + 7) // 8) for _ in range(20)]
            for first in 0, 9:
                rows = [[bytes([first + dice.randrange(20)]) for _ in range(width)] for _ in range(height)]
                # Neither takes alpha of 16 bits from a palette; Pillow takes none of 32.
                by = {15: ("magick",), 16: () if alpha else both, 24: both, 32: ("magick",) if alpha else ()}[bits]
                yield Case(f"palette-{first}-{bits}-{alpha}-{name}",
                           tga(rows, 1, 8, direction | alpha, colors, first, bits, runs), [[color_of(colors[c[0] - first], bits, alpha) for c in row] for row in rows],
                           by=by, near=0 if bits > 16 else 1)
        rows = [[bytes([dice.randrange(3)]) for _ in range(width)] for _ in range(height)]
        yield Case(f"grey-{name}", tga(rows, 3, 8, direction, runs=runs), [[(c[0], c[0], c[0], 255) for c in row] for row in rows], by=both)
        rows = [[bytes([dice.randrange(256), dice.randrange(2)]) for _ in range(width)] for _ in range(height)]
        yield Case(f"grey-alpha-{name}", tga(rows, 3, 16, direction | 8, runs=runs), [[(c[0], c[0], c[0], c[1]) for c in row] for row in rows],
                   by=("pillow",))
    for mode, runs in itertools.product(("L", "LA", "P", "RGB", "RGBA"), (None, "tga_rle")):
        yield of_pillow(f"written-{mode}-{runs}", mode, "TGA", by=("pillow",) if mode == "LA" else ("pillow", "magick"), compression=runs)


# ---- GIF


def gif_codes(indices, bits):
    """With codes that grow, as of LZW."""
    clear = 1 << bits
    table, size, value, count = {(k,): k for k in range(clear)}, bits + 1, 0, 0

    def put(code):
        nonlocal value, count
        value |= code << count
        count += size

    put(clear)
    word, top = (), clear + 2
    for index in indices:
        if (*word, index) in table:
            word = (*word, index)
            continue
        put(table[word])
        table[(*word, index)] = top
        top += 1
        if top > 1 << size and size < 12:
            size += 1
        if top == 4096:
            put(clear)
            table, size, top = {(k,): k for k in range(clear)}, bits + 1, clear + 2
        word = (index,)
    put(table[word])
    put(clear + 1)
    data = value.to_bytes((count + 7) // 8, "little")
    blocks = b"".join(bytes([len(data[at:at + 255])]) + data[at:at + 255] for at in range(0, len(data), 255))
    return bytes([bits]) + blocks + b"\0"


def gif(rows, bits, canvas, left=0, top=0, colors=None, own=None, transparent=None, interlaced=False, background=0, tail=b""):
    def table(entries):
        return b"".join(map(bytes, entries)) if entries else b""
    flags = 0x70 | (0x80 | (len(colors).bit_length() - 2) if colors else 0)
    out = struct.pack("<6sHHBBB", b"GIF89a", *canvas, flags, background, 0) + table(colors)
    out += b"!\xfe\x05hello\0" + b"!\xff\x0bNETSCAPE2.0\3\1\0\0\0"
    if transparent is not None:
        out += b"!\xf9\4" + struct.pack("<BHBB", 1, 10, transparent, 0)
    order = rows if not interlaced else [*rows[::8], *rows[4::8], *rows[2::4], *rows[1::2]]
    out += struct.pack("<BHHHHB", 0x2c, left, top, len(rows[0]), len(rows), (0x80 | (len(own).bit_length() - 2) if own else 0) | interlaced << 6)
    return out + table(own) + gif_codes([c for row in order for c in row], max(2, bits)) + tail + b";"


def gifs():
    for bits, interlaced, (width, height) in itertools.product((1, 2, 4, 8), (False, True), ((1, 1), (9, 9), (33, 20), (90, 70))):
        colors, rows = palette(1 << bits), codes(width, height, 1 << bits)
        name = f"{bits}-{interlaced}-{width}"
        yield Case(f"{name}", gif(rows, bits, (width, height), colors=colors, interlaced=interlaced), of_palette(rows, colors))
        yield Case(f"{name}-own", gif(rows, bits, (width, height), colors=palette(4), own=colors, interlaced=interlaced), of_palette(rows, colors))
        yield Case(f"{name}-only-own", gif(rows, bits, (width, height), own=colors, interlaced=interlaced), of_palette(rows, colors))
        clear = [[(*colors[c], 0 if c == 1 else 255) for c in row] for row in rows]
        yield Case(f"{name}-clear", gif(rows, bits, (width, height), colors=colors, interlaced=interlaced, transparent=1), clear)
        # Frames behind the first one change nothing.
        second = gif(rows[::-1], bits, (width, height), own=palette(1 << bits))
        yield Case(f"{name}-two", gif(rows, bits, (width, height), colors=colors, interlaced=interlaced, tail=second[13:-1]), of_palette(rows, colors))
        for transparent, background in (None, 0), (1, 0), (None, 1):
            inside = clear if transparent == 1 else of_palette(rows, colors)
            outside = (*colors[1], 0) if transparent == 1 else (*colors[background], 255)
            placed = [[outside] * (width + 7) for _ in range(height + 5)]
            for y, row in enumerate(inside):
                placed[y + 3][2:2 + width] = row
            # Pillow takes index 0 for the background, and ImageMagick always a clear one.
            by = ("pillow", "magick") if transparent == 1 else ("pillow",) if background == 0 else ()
            yield Case(f"{name}-placed-{transparent}-{background}",
                       gif(rows, bits, (width + 7, height + 5), 2, 3, colors, transparent=transparent, interlaced=interlaced, background=background), placed, by=by)
    colors, rows = palette(4), codes(5, 4, 4)
    placed = [[(0, 0, 0, 0)] * 8 for _ in range(8)]
    for y, row in enumerate(of_palette(rows, colors)):
        placed[y + 3][2:7] = row
    yield Case("no-background", gif(rows, 2, (8, 8), 2, 3, own=colors), placed, by=())
    beyond = codes(9, 9, 16)
    yield Case("beyond", gif(beyond, 4, (9, 9), colors=palette_of_two), of_palette(beyond, palette_of_two), by=())
    yield Case("leaves", gif(rows, 2, (3, 2), colors=colors), of_palette(rows, colors), by=("pillow",))
    for mode in "L", "P", "1":
        yield of_pillow(f"written-{mode}", mode, "GIF")


palette_of_two = palette(2)


# ---- PNM


def pnms():
    for width, height in (1, 1), (8, 2), (13, 5):
        bits = codes(width, height, 2)
        rows = [[(0, 0, 0, 255) if c else (255, 255, 255, 255) for c in row] for row in bits]
        header = f"{width} {height}\n".encode()
        yield Case(f"p1-{width}", b"P1\n" + header + b"\n".join(b"".join(b"%d" % c for c in row) for row in bits), rows)
        yield Case(f"p1-spaces-{width}", b"P1 # c\n" + header + b"\n".join(b" ".join(b"%d" % c for c in row) for row in bits) + b"\n", rows)
        yield Case(f"p4-{width}", b"P4\n#\n" + header + b"".join(row_bytes(row, 1, 1) for row in bits), rows)
        for maximum in 1, 3, 15, 100, 254, 255, 256, 300, 1023, 4095, 65534, 65535:
            greys = codes(width, height, maximum + 1)
            grey_rows = [[(*[scaled(c, maximum)] * 3, 255) for c in row] for row in greys]
            colors = [[tuple(dice.randrange(maximum + 1) for _ in range(3)) for _ in range(width)] for _ in range(height)]
            color_rows = [[(*(scaled(c, maximum) for c in color), 255) for color in row] for row in colors]
            flat = [c for row in colors for color in row for c in color]
            size, top = (1 if maximum < 256 else 2), b"%d" % maximum
            # Pillow makes 32-bit integers of greys of 16 bits, and rounds them in another way.
            by = ("pillow", "magick") if maximum < 256 else ("magick",)
            yield Case(f"p2-{width}-{maximum}", b"P2\n# a comment\n" + header + top + b"\n" + b"\n".join(b" ".join(b"%d" % c for c in row) for row in greys) + b"\n",
                       grey_rows, by=by, near=0 if maximum == 255 else 1)
            yield Case(f"p3-{width}-{maximum}", b"P3\n" + header + b"# c\n" + top + b"\n" + b" ".join(b"%d" % c for c in flat) + b"\n", color_rows,
                       near=0 if maximum == 255 else 1)
            yield Case(f"p5-{width}-{maximum}", b"P5 " + header + top + b"\n" + b"".join(c.to_bytes(size, "big") for row in greys for c in row), grey_rows,
                       by=by, near=0 if maximum == 255 else 1)
            yield Case(f"p6-{width}-{maximum}", b"P6\t" + header + top + b" " + b"".join(c.to_bytes(size, "big") for c in flat), color_rows,
                       near=0 if maximum == 255 else 1)


# ---- PNG and JPEG, which libraries read here, too


def pngs():
    for mode in "1", "L", "LA", "P", "RGB", "RGBA":
        yield of_pillow(f"written-{mode}", mode, "PNG")
    deep = codes(17, 4, 1 << 16)
    out = subprocess.run([MAGICK, "-depth", "16", "-size", "17x4", "gray:-", "-depth", "16", "-interlace", "PNG", "png:-"],
                         input=b"".join(c.to_bytes(2, "little") for row in deep for c in row), capture_output=True, check=True).stdout
    yield Case("grey-16-interlaced", out, [[(*[scaled(c, 65535)] * 3, 255) for c in row] for row in deep], by=("magick",), near=1)
    for mode in "RGB", "P":
        case = of_pillow(f"interlaced-{mode}", mode, "PNG")
        case.data = subprocess.run([MAGICK, "png:-", "-interlace", "PNG", "png:-"], input=case.data, capture_output=True, check=True).stdout
        yield case


def jpegs():
    # The readers share libjpeg; what differs is what stands around it: progressive, grey, and inks.
    for mode, progressive, subsampling in itertools.product(("L", "RGB"), (False, True), (0, 2)):
        image = picture("RGB", 40, 24).resize((80, 48), Image.Resampling.BICUBIC).convert(mode)
        out = io.BytesIO()
        image.save(out, "JPEG", quality=90, progressive=progressive, subsampling=subsampling)
        yield Case(f"{mode}-{progressive}-{subsampling}", out.getvalue(), rows_of(Image.open(io.BytesIO(out.getvalue()))), near=1)
    image = picture("RGB", 40, 24).resize((80, 48), Image.Resampling.BICUBIC).convert("CMYK")
    out = io.BytesIO()
    image.save(out, "JPEG", quality=95)
    yield Case("cmyk", out.getvalue(), rows_of(Image.open(io.BytesIO(out.getvalue())).convert("RGB")), by=("pillow",), near=2)


FORMATS = {"bmp": bmps, "tga": tgas, "gif": gifs, "pnm": pnms, "png": pngs, "jpg": jpegs}


class Images(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="bitspan-images-")))

    def texels_of_bitspan(self, files):
        """The program decodes all of them, and writes each as a PNG of four channels."""
        header = {"bitspan": 2, "width": 8, "height": 8, "s_min": 1, "s_max": 2, "focal": 8, "background": [0, 0, 0],
                  "textures": [file.name for file in files]}
        (self.folder / "in.tri").write_text(json.dumps(header) + "\n")
        run = subprocess.run([PROGRAM, "render", "in.tri", "-o", "a.png", "--emit-tri", "out.tri", "--plain-textures"], cwd=self.folder,
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        return [rows_of_file(self.folder / f"out.{k}.png") for k in range(len(files))]

    def texels_of_magick(self, files, form):
        """Raw texels, with no size: None where it does not read the file."""
        arguments = []
        for k, file in enumerate(files):
            arguments += ["(", f"{form}:{file.name}[0]", "-coalesce", "-auto-orient", "-depth", "8", "-write", f"rgba:{k}.magick", "+delete", ")"]
        subprocess.run([MAGICK, "xc:red", *arguments, "null:"], cwd=self.folder, capture_output=True, text=True)
        return [path.read_bytes() if (path := self.folder / f"{k}.magick").exists() else None for k in range(len(files))]

    def same(self, rows, case, reader, near=0):
        with self.subTest(case.name, reader=reader):
            self.assertIsNotNone(rows, "not read")
            self.assertEqual((len(rows[0]), len(rows)), (len(case.rows[0]), len(case.rows)))
            for y, x in itertools.product(range(len(rows)), range(len(rows[0]))):
                a, b = rows[y][x], case.rows[y][x]
                # What is clear may have any colour to another reader.
                clear = reader != "bitspan" and a[3] == b[3] == 0
                if not clear and max(abs(p - q) for p, q in zip(a, b)) > near:
                    self.fail(f"row {y}, column {x}: {a}; expected {b}")

    def check(self, form):
        cases = list(FORMATS[form]())
        self.assertEqual(len({case.name for case in cases}), len(cases))
        files = [self.folder / f"{k}.{form}" for k in range(len(cases))]
        for file, case in zip(files, cases):
            file.write_bytes(case.data)
        for rows, case in zip(self.texels_of_bitspan(files), cases):
            self.same(rows, case, "bitspan", case.near if form == "jpg" else 0)
        for file, case in zip(files, cases):
            if "pillow" in case.by:
                self.same(rows_of_file(file), case, "Pillow", case.near)
        chosen = [(file, case) for file, case in zip(files, cases) if "magick" in case.by]
        for raw, (_, case) in zip(self.texels_of_magick([file for file, _ in chosen], form), chosen):
            width = 4 * len(case.rows[0])
            rows = raw and [[tuple(raw[at + x:at + x + 4]) for x in range(0, width, 4)] for at in range(0, len(raw), width)]
            self.same(rows, case, "ImageMagick", case.near)
        by = {reader: sum(reader in case.by for case in cases) for reader in ("pillow", "magick")}
        alone = sum(not case.by for case in cases)
        texels = sum(len(case.rows) * len(case.rows[0]) for case in cases)
        print(f"{form}: {len(cases)} files, {texels} texels; {by['pillow']} as Pillow reads them, {by['magick']} as ImageMagick does, "
              f"{alone} as the description says alone", flush=True)
        self.assertGreater(by["pillow"], 5)
        self.assertGreater(by["magick"], 5)


class Use(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="bitspan-images-")))
        (self.folder / "quad.obj").write_text("mtllib quad.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                              "usemtl m\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")

    def render(self, *arguments):
        return subprocess.run([PROGRAM, "render", "quad.obj", "--no-cull", "--size", "64x48", "--yaw", "20", "--config", "depth20", *arguments],
                              cwd=self.folder, capture_output=True, text=True)

    def test_a_texture_by_flag_or_of_a_material_is_drawn_alike_in_every_format(self):
        image = picture("P", 16, 16).convert("RGB")
        pictures = set()
        for form in "PNG", "BMP", "TGA", "PPM", "GIF":
            image.quantize(256, kmeans=0, method=Image.Quantize.FASTOCTREE).save(self.folder / f"t.{form}", form) if form == "GIF" else \
                image.save(self.folder / f"t.{form}", form)
            (self.folder / "quad.mtl").write_text("newmtl m\nKd 1 1 1\n")
            run = self.render("--texture", f"t.{form}", "-o", f"{form}.flag.png")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            (self.folder / "quad.mtl").write_text(f"newmtl m\nKd 1 1 1\nmap_Kd t.{form}\n")
            run = self.render("-o", f"{form}.map.png")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            for kind in "flag", "map":
                pictures.add((self.folder / f"{form}.{kind}.png").read_bytes())
        self.assertEqual(len(pictures), 1)

    def test_what_is_not_read_is_named(self):
        (self.folder / "quad.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd t.img\n")
        for name, head in {"KTX": b"\xabKTX 11\xbb\r\n\x1a\n", "KTX 2": b"\xabKTX 20\xbb\r\n\x1a\n", "DDS": b"DDS |\0\0\0",
                           "WebP": b"RIFF\x20\0\0\0WEBPVP8L", "TIFF": b"II*\0\x08\0\0\0", "AVIF": b"\0\0\0\x20ftypavif",
                           "PAM": b"P7\nWIDTH 1\n"}.items():
            (self.folder / "t.img").write_bytes(head + bytes(1000))
            line = f"t.img: not an image that can be read: its format is {name}; expected a whole PNG, JPEG, BMP, TGA, GIF or PNM file"
            run = self.render("--texture", "t.img", "-o", "a.png")
            self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), run.stderr)
            self.assertIn(line, run.stderr)
            run = self.render("-o", "a.png")
            self.assertEqual((run.returncode, run.stderr.count("\n")), (0, 1), run.stderr)
            self.assertIn(line, run.stderr)
            run = self.render("--strict", "-o", "a.png")
            self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), run.stderr)
            self.assertIn(line, run.stderr)

    def test_a_file_without_an_end_is_not_read_whole(self):
        (self.folder / "quad.mtl").write_text("newmtl m\n")
        run = self.render("--texture", "/dev/zero", "-o", "a.png")
        self.assertEqual(run.returncode, 2)
        self.assertIn("/dev/zero: not an image that can be read", run.stderr)


for form in FORMATS:
    setattr(Images, f"test_{form}", lambda self, form=form: self.check(form))


if __name__ == "__main__":
    unittest.main()
