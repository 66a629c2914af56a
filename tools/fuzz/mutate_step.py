#!/usr/bin/env python3
"""Damages a STEP file in one of nine ways, the same for the same seed.

usage: mutate_step.py FILE --seed S [--kind KIND] [-o OUT]

Kinds: what real damage looks like, from single bits to missing ends.
"""
import argparse
import pathlib
import random
import re
import sys

_REFERENCE = re.compile(rb"#\d+")
_REAL = re.compile(rb"(?<=[(,])-?\d+\.\d*(?:E[-+]?\d+)?(?=[,)])")
_INTEGER = re.compile(rb"(?<=[(,])\d+(?=[,)])")


def _data(text):
    """Where the first data section begins and ends."""
    start = text.find(b"DATA;") + 5
    end = text.rfind(b"ENDSEC;")
    return (start, end) if 5 <= start < end else (0, len(text))


def _lines(text):
    """The first and last line of the data, and all lines."""
    start, end = _data(text)
    lines = text.splitlines(keepends=True)
    first = text.count(b"\n", 0, start)
    last = max(first + 1, text.count(b"\n", 0, end))
    return min(first + 1, len(lines) - 1), min(last, len(lines)), lines


def _replace(text, pattern, rng, new):
    """One match in the data, chosen at random, replaced by new(match)."""
    start, end = _data(text)
    found = list(pattern.finditer(text, start, end))
    if not found:
        return text
    match = rng.choice(found)
    return text[:match.start()] + new(match.group()) + text[match.end():]


def bits(text, rng):
    start, end = _data(text)
    damaged = bytearray(text)
    for _ in range(rng.randint(1, 3)):
        damaged[rng.randrange(start, end)] ^= 1 << rng.randrange(8)
    return bytes(damaged)


def dropped_lines(text, rng):
    first, last, lines = _lines(text)
    at = rng.randrange(first, max(last, first + 1))
    del lines[at:at + rng.randint(1, 2)]
    return b"".join(lines)


def doubled_lines(text, rng):
    first, last, lines = _lines(text)
    at = rng.randrange(first, max(last, first + 1))
    lines.insert(at, lines[at])
    return b"".join(lines)


def references(text, rng):
    """A reference that leads somewhere else, to nothing, or to its own instance."""
    start, end = _data(text)
    numbers = _REFERENCE.findall(text, start, end)
    if not numbers:
        return text
    other = rng.choice([rng.choice(numbers), rng.choice(numbers), b"#999999999"])
    used = re.compile(rb"(?<=[(,])#\d+(?=[,)])")
    return _replace(text, used, rng, lambda _: other)


def huge_numbers(text, rng):
    huge = rng.choice([b"1.E300", b"-1.E300", b"1.E30", b"-1.E20", b"1.E400", b"1.E-300"])
    return _replace(text, _REAL, rng, lambda _: huge)


def not_numbers(text, rng):
    words = rng.choice([b"NaN", b"nan", b"INF", b"-INF", b"'1.'", b"$", b"*", b".T."])
    return _replace(text, _REAL, rng, lambda _: words)


def list_lengths(text, rng):
    """An item more or less in a list."""
    item = re.compile(rb"(?<=[(,])[^(),'/\s]+,")
    return _replace(text, item, rng, lambda old: rng.choice([b"", old + old]))


def integers(text, rng):
    new = rng.choice([b"0", b"1", b"2", b"7", b"25", b"26", b"2147483647", b"99999999999", b"-1"])
    return _replace(text, _INTEGER, rng, lambda _: new)


def truncation(text, rng):
    start, end = _data(text)
    return text[:rng.randrange(start, end)]


KINDS = {kind.__name__: kind for kind in (bits, dropped_lines, doubled_lines, references,
                                          huge_numbers, not_numbers, list_lengths, integers,
                                          truncation)}


def mutant(text, seed, kind=None):
    """(kind, damaged text): never the same text as before, unless nothing can be damaged that way."""
    rng = random.Random(seed)
    kind = kind or sorted(KINDS)[seed % len(KINDS)]
    for _ in range(20):
        damaged = KINDS[kind](text, rng)
        if damaged != text:
            break
    return kind, damaged


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--kind", choices=sorted(KINDS))
    parser.add_argument("-o", "--output", type=pathlib.Path)
    options = parser.parse_args()
    _, damaged = mutant(options.file.read_bytes(), options.seed, options.kind)
    if options.output:
        options.output.write_bytes(damaged)
    else:
        sys.stdout.buffer.write(damaged)


if __name__ == "__main__":
    main()
