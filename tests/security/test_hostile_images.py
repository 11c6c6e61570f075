"""Images that unpack to gigabytes, start other programs, or are none; and trees that lead away."""

import os
import struct
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from learning.patterns import SIZE, split_tree, stripes, trained
from PIL import Image
from security.bounded import Answer, answers, refused
from security.test_hostile_yaml import HOSTILE

from radhar_cli.dataset.image_file import MAX_SIDE, image_size, read_rgb
from radhar_cli.errors import FolderError

PICTURE = Image.fromarray(stripes(0, np.random.default_rng(0)))


def chunk(kind: bytes, data: bytes) -> bytes:
    whole = kind + data
    return struct.pack(">I", len(data)) + whole + struct.pack(">I", zlib.crc32(whole))


def png(width: int, height: int, *before: bytes, rows: int | None = None, depth: int = 8) -> bytes:
    """A black PNG; its rows are packed one by one, for it may not fit into memory."""
    packer = zlib.compressobj(9)
    row = bytes(1 + width * 3 * depth // 8)
    data = [packer.compress(row) for _ in range(height if rows is None else rows)]
    header = struct.pack(">IIBBBBB", width, height, depth, 2, 0, 0, 0)
    image = chunk(b"IDAT", b"".join(data) + packer.flush())
    start = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
    return start + b"".join(before) + image + chunk(b"IEND", b"")


def zeros(count: int) -> bytes:
    """A zlib stream of zeros."""
    packer = zlib.compressobj(9)
    return b"".join(packer.compress(bytes(2**20)) for _ in range(count // 2**20)) + packer.flush()


def saved(image: Image.Image, **how: object) -> Callable[[Path], object]:
    return lambda path: image.save(path, **how)  # type: ignore[arg-type]


def bytes_of(data: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(data)


def sparse(data: bytes, size: int) -> Callable[[Path], object]:
    def write(path: Path) -> None:
        path.write_bytes(data)
        os.truncate(path, size)

    return write


def tiff(*tags: tuple[int, int, int, int]) -> bytes:
    """A little-endian TIFF of one directory; tags are (number, type, count, value)."""
    entries = b"".join(struct.pack("<HHII", *tag) for tag in sorted(tags))
    return b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4 + 64)


def tiff_of(width: int, height: int, *more: tuple[int, int, int, int]) -> bytes:
    return tiff((256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, 8), (262, 3, 1, 1), *more)


# One tile of 2^16 x 2^16, deflated.
TILES = ((259, 3, 1, 8), (322, 4, 1, 2**16), (323, 4, 1, 2**16), (324, 4, 1, 8))
FRAMES = {"save_all": True, "append_images": [Image.new("RGB", (SIZE, SIZE))]}
WEBP_VP8X = b"RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xfe\x3f\0\xfe\x3f\0"
EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 32 32\n%%EndComments\n(x) run showpage\n"
BMP = struct.pack("<2sIIIIiiHHIIIIII", b"BM", 54, 0, 54, 40, 2**30, 2**30, 1, 24, 0, 0, 0, 0, 0, 0)

# {name of the file: (what writes it, the expected message)}
REFUSED: dict[str, tuple[Callable[[Path], object], str]] = {
    "13000.png": (bytes_of(png(13000, 13000, rows=0)), "is 13000 x 13000 px"),
    "20000.png": (bytes_of(png(20000, 20000, rows=0)), "400000000 pixels"),
    "2e9.png": (bytes_of(png(2**31 - 1, 2**31 - 1, rows=0)), "pixels"),
    "zero.png": (bytes_of(png(0, 0)), "zero.png: "),
    "short.png": (bytes_of(png(SIZE, SIZE)[:50]), "truncated"),
    "text.png": (bytes_of(png(SIZE, SIZE, chunk(b"zTXt", b"a\0\0" + zeros(2**28)))), "text.png: "),
    "many.png": (
        bytes_of(png(SIZE, SIZE, *[chunk(b"zTXt", b"a\0\0" + zeros(2**20))] * 200)),
        "many.png: ",
    ),
    "chunk.png": (
        sparse(png(SIZE, SIZE)[:33] + struct.pack(">I4s", 2**31 - 1, b"tEXt"), 2**28),
        "chunk.png: ",
    ),
    "sparse.png": (sparse(png(SIZE, SIZE), 2**40), "should be an image of at most"),
    "frames.png": (saved(PICTURE, **FRAMES), "several pictures"),
    "frames.webp": (saved(PICTURE, **FRAMES), "several pictures"),
    "frames.tif": (saved(PICTURE, **FRAMES), "several pictures"),
    "large.webp": (bytes_of(WEBP_VP8X), "large.webp: "),
    "large.bmp": (bytes_of(BMP), "large.bmp: "),
    "large.tif": (bytes_of(tiff_of(2**31 - 1, 2**31 - 1)), "large.tif: "),
    "tiles.tif": (
        bytes_of(
            tiff_of(
                SIZE, SIZE, (259, 3, 1, 8), (322, 4, 1, 2**16), (323, 4, 1, 2**16), (324, 4, 1, 8)
            )
        ),
        "tiles.tif: ",
    ),
    "tags.tif": (bytes_of(tiff_of(SIZE, SIZE, (270, 2, 2**32 - 1, 8))), "tags.tif: "),
    "loop.tif": (bytes_of(b"II*\0" + struct.pack("<IHI", 8, 0, 8)), "loop.tif: "),
    "eps.png": (bytes_of(EPS), "is not an image"),
    "gif.png": (saved(PICTURE, format="GIF"), "is not an image"),
    "ppm.png": (saved(PICTURE, format="PPM"), "is not an image"),
    "icon.png": (saved(PICTURE, format="ICO"), "is not an image"),
    "jp2.png": (bytes_of(b"\0\0\0\x0cjP  \r\n\x87\n" + bytes(64)), "is not an image"),
    "float.tif": (saved(PICTURE.convert("F")), "its mode is F; should be 8 or 16 bits"),
    "fifo.png": (os.mkfifo, "is not a data set"),
    "folder.png": (Path.mkdir, "holds no class folders"),
    "device.png": (lambda path: path.symlink_to("/dev/zero"), "is not a data set"),
    "loop.png": (lambda path: path.symlink_to(path), "no such file"),
    "other size.png": (bytes_of(png(SIZE, 2 * SIZE)), f"is {2 * SIZE} x {SIZE} px; should be"),
}
GREY = np.linspace(0, 65535, SIZE * SIZE).reshape(SIZE, SIZE).astype(np.uint16)
READ: dict[str, Callable[[Path], object]] = {
    "16 bit.png": saved(Image.fromarray(GREY)),
    "16 bit.tif": saved(Image.fromarray(GREY)),
    "48 bit.png": bytes_of(png(SIZE, SIZE, depth=16)),
    "palette.png": saved(PICTURE.convert("P")),
    "bits.png": saved(PICTURE.convert("1")),
    "transparent.png": saved(PICTURE.convert("LA")),
    "cmyk.jpg": saved(PICTURE.convert("CMYK")),
    "one.webp": saved(PICTURE),
    "\x1b[2J\u202e[red].png": saved(PICTURE),
    "\udcff.png": saved(PICTURE),
}


def classes(root: Path, *names: str) -> Path:
    """A tree of one image a class."""
    for name in names:
        (root / name).mkdir(parents=True)
        PICTURE.save(root / name / "0.png")
    return root


def trees(place: Path) -> dict[str, tuple[Path, str]]:
    """{name: (tree, the expected message)}."""
    elsewhere = classes(place / "elsewhere", "c")
    out = classes(place / "out", "a", "b")
    (out / "c").symlink_to(elsewhere / "c")
    one = classes(place / "one", "a", "b")
    (one / "a/9.png").symlink_to(elsewhere / "c/0.png")
    circle = classes(place / "circle", "a", "b")
    (circle / "c").symlink_to(circle / "c")
    (circle / "a/x.png").symlink_to(circle / "a")
    (circle / "a/0.png").write_bytes(b"")
    return {
        "a link out": (out, "outside of"),
        "a file's link out": (one, "9.png: is a link to"),
        "links in a circle": (circle, "0.png: is not an image"),
        "many classes": (
            classes(place / "many", *(f"c{i}" for i in range(129))),
            "has 129 classes; should have at most 128",
        ),
        "escapes": (
            classes(place / "1", "a", "\x1b[2J[red]"),
            r"'\x1b[2J[red]' should have a name",
        ),
        "no UTF-8": (classes(place / "2", "a", "\udcff"), r"'\udcff' should have"),
        "a line break": (classes(place / "3", "a", "b\nradhar: x"), r"'b\nradhar: x' should have"),
    }


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("images")


@pytest.fixture(scope="module")
def given(place: Path) -> dict[str, Answer]:
    """What `predict` says of every image, and `train` of every tree."""
    data = split_tree(place / "tree", classes=("a$x$", "b_$\\frac$"))
    run = place / "run"
    trained(data, run, epochs=1, model="smallnet", input="gray")
    cases: dict[str, Sequence[object]] = {}
    for name, (write, _) in REFUSED.items():
        write(place / name)
        cases[name] = ["predict", run, place / name]
    for name, write_image in READ.items():
        write_image(place / name)
        cases[name] = ["predict", run, place / name]
    for name, (root, _) in trees(place).items():
        cases[name] = ["train", root, "-o", place / "new", "--set", "epochs=1"]
    cases["folder with a link out"] = ["predict", run, place / "one/a"]
    laughs = place / "set/png/stft/val/a"
    laughs.mkdir(parents=True)
    (place / "set/config.yaml").write_text(HOSTILE["aliases in lists"][0])
    PICTURE.save(laughs / "0.png")
    cases["a hostile config beside it"] = ["predict", run, laughs / "0.png"]
    for odd in ("\udcff.png", "\x1b[2J.png"):
        PICTURE.save(data / "val/a$x$" / odd)
    cases["eval"] = ["eval", run, data]
    return answers(place, cases, warm_up=[["predict", run, data / "val", "--split", "all"]])


@pytest.mark.every(3)
@pytest.mark.parametrize("name", REFUSED)
def test_a_hostile_image_is_refused(given: dict[str, Answer], name: str) -> None:
    assert REFUSED[name][1] in refused(given[name])


@pytest.mark.parametrize("name", [*READ, "a hostile config beside it", "eval"])
def test_an_unusual_image_is_read(given: dict[str, Answer], name: str) -> None:
    answer = given[name]
    assert answer.status == 0, answer
    assert all(c.isprintable() or c == "\n" for c in answer.out + answer.err)


def test_a_hostile_tree_is_refused(given: dict[str, Answer], tmp_path: Path) -> None:
    for name, (_, says) in trees(tmp_path).items():
        assert says in refused(given[name]), name
    assert "lies outside of" in refused(given["folder with a link out"])


def test_the_size_is_known_before_the_pixels(tmp_path: Path) -> None:
    path = tmp_path / "x.png"
    path.write_bytes(png(MAX_SIDE, MAX_SIDE, rows=0))
    assert image_size(path) == (MAX_SIDE, MAX_SIDE)
    with pytest.raises(FolderError, match="truncated"):
        read_rgb(path)
    with pytest.raises(FolderError, match=r"is 8192 x 8192 px; should be 32 x 32"):
        read_rgb(path, (SIZE, SIZE))


def test_levels_of_16_bits_are_scaled_and_transparency_is_dropped(place: Path) -> None:
    for name in ("16 bit.png", "16 bit.tif"):
        READ[name](place / name)
        assert np.array_equal(read_rgb(place / name)[..., 1], np.round(GREY / 257))
    READ["transparent.png"](place / "transparent.png")
    assert np.array_equal(
        read_rgb(place / "transparent.png")[..., 0], np.asarray(PICTURE.convert("L"))
    )
