#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a file of PMTiles 3 by its specification alone, and holds it to that.

usage: pmtiles_reader.py FILE FOLDER [N]
Writes each tile (of N one, by number) as FOLDER/z-x-y, the metadata as FOLDER/metadata.json, and prints a line of counts:
tiles, entries, contents, leaf directories.
"""
import gzip
import os
import struct
import sys


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at


def directory(data):
    count, at = varint(data, 0)
    columns = []
    for _ in range(4):
        column = []
        for _ in range(count):
            value, at = varint(data, at)
            column.append(value)
        columns.append(column)
    assert at == len(data), "a directory has bytes behind it"
    entries, tile = [], 0
    for i, (step, run, length, offset) in enumerate(zip(*columns)):
        tile += step
        assert i == 0 or step > 0, "tiles of a directory ascend"
        place = entries[-1][1] + entries[-1][2] if offset == 0 else offset - 1
        entries.append((tile, place, length, run))
    return entries


def zxy(tile):
    """The specification's Hilbert curve, from a number to a tile."""
    z, first = 0, 0
    while tile >= first + 4**z:
        first += 4**z
        z += 1
    rest, x, y, side = tile - first, 0, 0, 1
    while side < 2**z:
        rx = 1 & (rest // 2)
        ry = 1 & (rest ^ rx)
        if ry == 0:
            if rx == 1:
                x, y = side - 1 - x, side - 1 - y
            x, y = y, x
        x += side * rx
        y += side * ry
        rest //= 4
        side *= 2
    return z, x, y


def main(path, folder, some=1):
    data = open(path, "rb").read()
    assert data[:8] == b"PMTiles\x03", "magic and version"
    (root, root_bytes, told, told_bytes, leaves, leaves_bytes, tiles, tiles_bytes, addressed, entries_told,
     contents_told) = struct.unpack("<11Q", data[8:96])
    clustered, inner, outer, _, low, high = data[96:102]
    west, south, east, north = struct.unpack("<4i", data[102:118])
    assert (clustered, inner, outer) == (1, 2, 1)
    assert root + root_bytes <= 16384 and tiles + tiles_bytes == len(data)
    assert -1800000000 <= west and east <= 1800000000 and -900000000 <= south <= north <= 900000000
    with open(os.path.join(folder, "metadata.json"), "wb") as out:
        out.write(gzip.decompress(data[told:told + told_bytes]))
    found, entry_count, leaf_count, end = {}, 0, 0, 0
    contents = set()
    for tile, place, length, run in directory(gzip.decompress(data[root:root + root_bytes])):
        rows = [(tile, place, length, run)]
        if run == 0:
            assert place + length <= leaves_bytes
            leaf_count += 1
            rows = directory(gzip.decompress(data[leaves + place:leaves + place + length]))
            assert rows[0][0] == tile
        for number, offset, size, times in rows:
            assert times > 0 and offset + size <= tiles_bytes
            assert offset <= end, "clustered: a new tile follows the one before"
            end = max(end, offset + size)
            entry_count += 1
            contents.add((offset, size))
            for k in range(times):
                assert number + k not in found
                found[number + k] = data[tiles + offset:tiles + offset + size]
    assert (len(found), entry_count, len(contents)) == (addressed, entries_told, contents_told)
    for number, content in found.items():
        z, x, y = zxy(number)
        assert low <= z <= high
        if number % some != 0:
            continue
        with open(os.path.join(folder, f"{z}-{x}-{y}"), "wb") as out:
            out.write(content)
    print(len(found), entry_count, len(contents), leaf_count)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], *map(int, sys.argv[3:]))
