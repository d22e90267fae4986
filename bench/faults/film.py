# SPDX-License-Identifier: Apache-2.0
"""Reads film files by their description in docs/film-files.md, without Fathom's code."""
import struct


def read_film(path):
    """Returns the text attributes and the words of the sums, row by row."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:4] == b"\x76\x2f\x31\x01", "no EXR"
    at, texts, channels, window = 8, {}, [], None

    def word():
        nonlocal at
        end = data.index(0, at)
        text = data[at:end].decode()
        at = end + 1
        return text

    while data[at] != 0:
        name, kind = word(), word()
        size, = struct.unpack_from("<i", data, at)
        value = data[at + 4:at + 4 + size]
        if kind == "string":
            texts[name] = value.decode()
        elif kind == "chlist":
            while value[0] != 0:
                end = value.index(0)
                channels.append((value[:end].decode(), 2 if struct.unpack_from("<i", value, end + 1)[0] == 1 else 4))
                value = value[end + 17:]
        elif name == "dataWindow":
            window = struct.unpack("<4i", value)
        at += 4 + size
    width, height = window[2] + 1, window[3] + 1
    places = struct.unpack_from(f"<{height}Q", data, at + 1)
    lines = []
    for y, place in enumerate(places):
        number, _ = struct.unpack_from("<2i", data, place)
        assert number == y, "lines are out of order"
        place, words = place + 8, []
        for channel, size in channels:
            if channel.startswith("sums."):
                words.append(data[place:place + 4 * width])
            place += size * width
        lines.append(words)
    return texts, lines


def numbers_of(path):
    """Returns the exact integer sums of each pixel: {(x, y): [...]}."""
    texts, lines = read_film(path)
    packing = [tuple(map(int, number.split("+"))) for number in texts["fathom.sums.packing"].split(",")]
    pixels = {}
    for y, words in enumerate(lines):
        for x in range(len(words[0]) // 4 if words else 0):
            packed, at, numbers = b"".join(word[4 * x:4 * x + 4] for word in words), 0, []
            for i, (first, count) in enumerate(packing):
                # Squares and ids are unsigned; ids, if any, are the last three numbers, of 4 bytes.
                signed = not 3 <= i < 6
                numbers.append(int.from_bytes(packed[at:at + count], "little", signed=signed) << 8 * first)
                at += count
            pixels[x, y] = numbers
    return texts, pixels
