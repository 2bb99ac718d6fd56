# SPDX-License-Identifier: Apache-2.0
"""Writes a binary triangle stream (docs/formats.md) with Python alone: python3 write_trib.py OUT.trib"""
import json
import struct
import sys
import zlib


class TribWriter:
    def __init__(self, path, **header):
        self.file, self.crc, self.block = open(path, "wb"), 0, b""
        self.file.write(b"\x89TRIB1\r\n")
        self.block = struct.pack("<I4sI4sI4sI", 3, b"T", 128, b"T\1", 224, b"C", 128) + json.dumps(header).encode()
        self.flush()

    def flush(self):
        self.crc = zlib.crc32(self.block, self.crc)
        self.file.write(struct.pack("<II", len(self.block), self.crc) + self.block)
        self.block = b""

    def record(self, bytes):
        self.block += bytes
        if len(self.block) > 1 << 16:
            self.flush()

    def triangle(self, v, c=None, tex=-1):  # three of [x, y, s, u, v]; three of [red, green, blue, alpha]
        tag, numbers = (b"T", sum(v, [])) if c is None else (b"T\1", sum(v, []) + sum(c, []))
        self.record(struct.pack(f"<4si{len(numbers)}d", tag, tex, *numbers))

    def command(self, line):  # at most 124 bytes of JSON
        self.record(struct.pack("<4s124s", b"C", json.dumps(line).encode()))

    def close(self):
        if self.block:
            self.flush()
        self.flush()
        self.file.close()


if __name__ == "__main__":
    out = TribWriter(sys.argv[1], bitspan=2, width=640, height=480, s_min=1, s_max=1000, focal=500,
                     background=[32, 40, 64], color_max=255)
    for k in range(16):
        x, y = 40.0 + 140 * (k % 4), 30.0 + 110 * (k // 4)
        color = [[255, 16 * k, 0, 255], [0, 255, 16 * k, 255], [16 * k, 0, 255, 128]]
        out.triangle([[x, y, 20, 0, 0], [x + 120, y, 20, 0, 0], [x, y + 90, 5 + k, 0, 0]], color if k % 2 else None)
        out.command({"state": {"depth.func": "lequal" if k % 2 else "less"}})
    out.close()
