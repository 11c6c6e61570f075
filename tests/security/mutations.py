"""Damage that a file may have met by chance or by intent; `rng` decides it."""

import random

TOKENS = (
    *("[", "]", "{", "}", ": ", "- ", "? ", "&a ", "*a", "<<: *a", "!!int ", "!x ", "|\n", ">\n"),
    *("'", '"', "#", "%YAML 9.9\n", "---\n", "...\n", "\t", "\0", "\x1b[2J", "\u202e", "\ufeff"),
    *("null", "~", "true", ".nan", ".inf", "-.inf", "-0.0", "1e308", "1e-320", "1e999", "0x10"),
    *("9" * 400, "9" * 5000, "-1", "0", "2.5", "'3'", "[]", "{}", "[[[[[[[[", "x" * 3000, "\ud7ff"),
    *("{uniform: [1, 2]}", "{normal: [0, 1e30]}", "{choice: []}", "{vary: [1, 0.5]}", "2001-01-01"),
)


def mutate_yaml(rng: random.Random, text: str) -> str:
    """A text with one to four lines moved, lost, doubled or nested, or tokens set in."""
    for _ in range(rng.randint(1, 4)):
        lines = text.split("\n")
        at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
        kind = rng.randrange(8)
        if kind == 0:
            del lines[at]
        elif kind == 1:
            lines.insert(other, lines[at])
        elif kind == 2:
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 3:
            lines[at] = " " * rng.randint(0, 6) + lines[at].strip()
        elif kind == 4:  # another value
            key, colon, _ = lines[at].rpartition(":")
            lines[at] = f"{key}{colon} {rng.choice(TOKENS)}"
        elif kind == 5:
            lines[at] = lines[at][: rng.randint(0, len(lines[at]))]
        elif kind == 6:  # many times over
            lines[at:at] = [f"k{i}: {rng.choice(TOKENS)}" for i in range(rng.randint(1, 300))]
        else:
            place = rng.randint(0, len(lines[at]))
            lines[at] = lines[at][:place] + rng.choice(TOKENS) + lines[at][place:]
        text = "\n".join(lines)
    return text


def mutate_image(rng: random.Random, data: bytes) -> bytes:
    """Bytes with one to four places turned over, overwritten, cut, moved or doubled.

    Half of them lie in the first 100 bytes, where the headers are.
    """
    for _ in range(rng.randint(1, 4)):
        end = min(100, len(data)) if rng.random() < 0.5 else len(data)
        at, other = rng.randrange(end + 1), rng.randrange(len(data) + 1)
        length = rng.choice((1, 2, 4, 8, 100))
        kind = rng.randrange(6)
        if kind == 0 and at < len(data):
            data = data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
        elif kind == 1:
            value = rng.choice((b"\0", b"\1", b"\x7f", b"\x80", b"\xff"))
            data = data[:at] + length * value + data[at + length :]
        elif kind == 2:
            data = data[:at] if rng.random() < 0.2 else data[:at] + data[at + length :]
        elif kind == 3:
            data = data[:at] + data[other : other + length] + data[at:]
        elif kind == 4:
            data = data[:at] + rng.randbytes(length) + data[at + length :]
        else:
            data = data[:at] + data[other : other + length] + data[at + length :]
    return data


def mutate_file(rng: random.Random, data: bytes) -> bytes:
    """The bytes with one to four faults: flips, odd numbers, cuts, repetitions, odd words."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        place = rng.randrange(len(changed) + 1)
        width = rng.choice((1, 2, 4, 8))
        kind = rng.randrange(7)
        if kind == 0 and place < len(changed):
            changed[place] ^= 1 << rng.randrange(8)
        elif kind == 1:
            number = rng.choice((0, 1, 255, 2**31 - 1, 2**63 - 1, 2**64 - 1, rng.getrandbits(64)))
            changed[place : place + width] = number.to_bytes(8, "little")[:width]
        elif kind == 2:
            del changed[place:]
        elif kind == 3:
            del changed[place : place + rng.randrange(1, 64)]
        elif kind == 4:
            changed[place:place] = changed[place : place + rng.randrange(1, 256)]
        elif kind == 5:
            odd = (b"null", b"-1", b"1e999", b"NaN", b"[", b'"', b"{}", b"\xff\xfe", b"9" * 400)
            changed[place : place + width] = rng.choice(odd)
        else:
            start = rng.randrange(len(changed) + 1)
            changed[place : place + width] = changed[start : start + width]
    return bytes(changed)
