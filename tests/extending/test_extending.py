"""What the field adds next is added through public names, in about 20 lines each."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml
from helpers import command_line
from helpers.listener import Listener
from helpers.signals import signal
from pydantic import ValidationError

from radhar_cli import extensions
from radhar_cli.config import Config, load_config
from radhar_cli.config.maps import CADENCE_MAPS
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.receiver import ToneConfig
from radhar_cli.dataset.build import build
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.verify import verify
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.errors import ConfigError, RadharError, SceneError
from radhar_cli.motion.activities import activity
from radhar_cli.motion.activities.activity import activity_named, add_activity
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.look import Look
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.track import StandingTrack
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import make_impairments
from radhar_cli.scene.products.run import process, record
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.scene import Person, Scene, nominal_scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO

C = 299_792_458.0
RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500, "antenna_isolation_db": 300}
CONFIG = Config.model_validate(
    {
        "radar": RADAR,
        "snr_db": None,
        "duration_s": 2.0,
        "motion": {"model": "paper", "range_m": 2.0, "angle_deg": 0.0},
        "image": {"size_px": 32},
    }
)


def walking(**more: object) -> Scene:
    config = CONFIG.model_copy(update=more)
    return nominal_scene(config, activity_named("walking"))


def ridge(found: PowerMap) -> Float:
    """Row value of the largest power in every column."""
    return found.rows.values[found.power.argmax(axis=0)]


@dataclass(frozen=True)
class Ball:
    """A ball on a string, swinging along the range axis."""

    place: float
    swing: float = 0.3
    rate: float = 0.5

    names, parents = ("ball",), (None,)
    breakpoints = phases = ()

    @property
    def highest_frequency(self) -> float:
        return self.rate

    def positions(self, t: Float) -> Float:
        x = self.place + self.swing * np.sin(2 * np.pi * self.rate * t)
        return np.stack([x, np.zeros_like(t), np.full_like(t, 1.5)])[:, None]

    def cross_sections(self, t: Float) -> Float:
        return np.array([[0.01]])

    torso = positions


def swinging(person: Person) -> Ball:
    """A user-defined class: it reads what it needs off the numbers of the person."""
    return Ball(person.place[0])


def test_a_motion_with_other_joints() -> None:
    ball = Ball(2.0)
    found = record(walking(), ["stft", "waveform"], motions=(ball,))
    t = found["stft"].columns.values
    speed = ball.swing * 2 * np.pi * ball.rate * np.cos(2 * np.pi * ball.rate * t)
    expected = -2 * speed * found["waveform"].f0 / C
    rows = found["stft"].rows.values
    # Two rows of rounding and the bend within a frame; the antennas are 0.1 m off the axis.
    assert np.abs(ridge(found["stft"]) - expected).max() < 3 * (rows[1] - rows[0])


def test_a_second_person() -> None:
    scene = walking()
    first = motion_of(scene.people[0])
    second = replace(first, start=(3.0, 1.0), angle=np.pi)
    alone = [record(scene, ["signal"], motions=(one,))["signal"].x for one in (first, second)]
    both = record(scene, ["signal"], motions=(first, second))["signal"].x
    assert np.linalg.norm(both - sum(alone)) < 1e-3 * np.linalg.norm(both)
    assert np.linalg.norm(both - alone[0]) > 0.1 * np.linalg.norm(both)


def test_a_second_receive_channel() -> None:
    """Two receivers half a wavelength apart see a body to the left by a phase between them."""
    scene = walking()
    antennas, waveform = antennas_of(scene), waveform_of(scene)
    apart = C / waveform.f0 / 2
    x, y, z = antennas.rx
    beside = replace(antennas, rx=(x, y + apart, z))
    left = replace(motion_of(scene.people[0]), start=(3.0, 1.5), angle=0.0)
    channels = [
        record(scene, ["signal"], motions=(left,), antennas=one)["signal"].x
        for one in (antennas, beside)
    ]
    phase = np.angle(np.vdot(channels[0], channels[1]))
    # The body walks from 3 to 6 m ahead at 1.5 m to the left: 0.53 to 0.27 rad off broadside.
    angle = np.arcsin(phase * waveform.wavelength / (2 * np.pi * apart))
    assert 0.2 < angle < 0.6


FORMS = {  # of the echo, by the product that shows its noise, and the config that has it
    "raw": ("raw_echo", {}),
    "coherent sum": ("signal", {"clutter": "none"}),
    "range profiles": ("range_profiles", {}),
    "range bins": ("range_signals", {"range_sum": "gated", "gate_m": (1.0, 3.0)}),
}


def noise_of(scene: Scene, form: str, **given: object) -> Complex:
    """What a scene with noise differs in from one without."""
    product, processing = FORMS[form]
    processing = scene.config.processing.model_copy(update=processing)
    noisy = scene.config.model_copy(update={"processing": processing})
    clean = noisy.model_copy(update={"snr_db": None})
    made = [
        record(replace(scene, config=config), [product], [RAW_ECHO], **given)[product]
        for config in (noisy, clean)
    ]
    samples = [getattr(one, "x", one) for one in made]
    return (samples[0] - samples[1]).ravel()


def correlation(x: Complex, y: Complex) -> float:
    return float(abs(np.vdot(x, y)) / (np.linalg.norm(x) * np.linalg.norm(y)))


@pytest.mark.every(4)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("corner", [0.0, 1000.0])
def test_channels_have_noise_of_their_own(engine: str, form: str, corner: float) -> None:
    """Other antennas, or the same ones by another number, share no noise; again is the same."""
    fast = CONFIG.radar.model_copy(update={"prf_hz": 20e3, "adc_rate_hz": 4e5})
    kind = CONFIG.engine.model_copy(update={"kind": engine})
    flicker = {"noise_corner_hz": corner, "noise_slope_db": 2.0}
    receiver = CONFIG.receiver.model_copy(update=flicker)
    wide = CONFIG.image.model_copy(update={"size_px": (32, 8192)})  # pulses of range profiles
    scene = walking(radar=fast, engine=kind, snr_db=0, receiver=receiver, image=wide)
    antennas = antennas_of(scene)
    beside = replace(antennas, rx=(0.4, 0.115, 1.5))
    channels = [
        noise_of(scene, form, motions=(Ball(2.0),), antennas=one, **named)
        for one, named in ((antennas, {}), (beside, {}), (antennas, {"channel": 1}))
    ]
    for one, other in combinations(channels, 2):
        assert correlation(one, other) < 0.02
    again = noise_of(scene, form, motions=(Ball(2.0),), antennas=replace(antennas))
    assert np.array_equal(again, channels[0])


def test_interference_comes_from_outside_and_is_the_same_in_all_channels() -> None:
    line = ToneConfig(doppler_hz=100.0, level_db=40.0)
    receiver = CONFIG.receiver.model_copy(update={"tones": (line,)})
    scene = walking(snr_db=0, receiver=receiver)
    one, other = (noise_of(scene, "coherent sum", channel=n) for n in range(2))
    assert correlation(one, other) > 0.99


def range_speed(beat: Complex, w: Waveform) -> PowerMap:
    """Range against Doppler over the whole recording."""
    spectrum = np.fft.fftshift(np.fft.fft(range_compression(beat, w), axis=1), axes=1)
    doppler = np.fft.fftshift(np.fft.fftfreq(beat.shape[1], 1 / w.prf))
    rows = Axis("range", "m", w.range_axis())
    return PowerMap(np.abs(spectrum) ** 2, rows, Axis("frequency", "Hz", doppler))


def test_a_product() -> None:
    row = Product("range_speed", ("raw_echo", "waveform"), range_speed, "range, Doppler")
    ball = Ball(2.0)
    found = record(walking(), ["range_speed"], [RAW_ECHO, row], motions=(ball,))["range_speed"]
    moving = np.abs(found.columns.values) > 5
    at, _ = np.unravel_index(np.argmax(found.power[:, moving]), found.power[:, moving].shape)
    assert abs(found.rows.values[at] - (2.0 - 0.4)) < 0.35
    assert found.extent[2] < 1.6 < found.extent[3]


class DcOffset(Impairment):
    """A constant on every raw sample."""

    def apply(self, x: Complex, look: Look) -> Complex:
        ones = look.fast(np.ones((look.fast.waveform.n_adc, 1), complex))
        return x + ones * look.after_taps(lambda pulses: np.ones(pulses.shape, complex))


class Saturation(Impairment):
    """An amplifier that takes a tenth off the strongest echo."""

    additive = False

    def apply(self, x: Complex, look: Look) -> Complex:
        return x / (1 + 0.1 * np.abs(x) / np.abs(x).max())


def receiver_with(impairment: Impairment) -> Product:
    return Product("receiver", (), lambda: (impairment,), "an impairment")


def with_engine(kind: str, **processing: object) -> Scene:
    return walking(
        engine=CONFIG.engine.model_copy(update={"kind": kind}),
        processing=CONFIG.processing.model_copy(update=processing),
    )


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_an_impairment_between_echo_and_processing(engine: str) -> None:
    """A DC offset is a line at zero Doppler, which the canceller removes."""
    scene, offset, none = with_engine(engine), receiver_with(DcOffset()), Fir((1,))
    clean = record(scene, ["stft"])["stft"]
    cancelled = record(scene, ["stft"], [offset])["stft"]
    plain = record(scene, ["stft"], [offset], canceller=none)["stft"]
    assert np.all(np.abs(ridge(plain)) < 5)
    assert np.abs(cancelled.power - clean.power).max() < 1e-6 * clean.power.max()


@pytest.mark.parametrize("processing", [{}, {"range_sum": "gated", "gate_m": (0.0, 3.0)}])
def test_an_impairment_is_in_every_map_of_every_engine(processing: dict[str, object]) -> None:
    scenes = [with_engine(kind, clutter="none", **processing) for kind in ("direct", "cube")]
    steady = set(possible_maps(scenes[0].config)) - set(CADENCE_MAPS)  # which lose their mean
    for name in sorted(steady):
        direct, cube = (
            record(scene, [name], [receiver_with(DcOffset())])[name].power.sum() for scene in scenes
        )
        assert cube > 100 * record(scenes[1], [name])[name].power.sum()
        assert direct == pytest.approx(cube, rel=1e-3), name


def test_an_impairment_that_does_not_add_needs_the_exact_engine() -> None:
    scene, image = with_engine("cube", clutter="none"), receiver_with(Saturation())
    found, right = (record(scene, ["signal"], more)["signal"].x for more in ([image], []))
    assert np.linalg.norm(found - right) > 0.02 * np.linalg.norm(right)
    for asked in ("signal", "rtm"):
        with pytest.raises(SceneError, match=r"Saturation: is not additive, .*engine.kind: cube"):
            record(with_engine("direct"), [asked], [image])


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_an_impairment_without_apply_is_refused(engine: str) -> None:
    for asked in ("raw_echo", "stft", "rtm"):
        with pytest.raises(RadharError, match="has no method apply"):
            record(with_engine(engine), [asked], [RAW_ECHO, receiver_with(Impairment())])


def test_a_recorded_signal_in_place_of_a_simulated_one() -> None:
    prf = 1000.0
    t = np.arange(4000) / prf
    tone = signal(np.exp(2j * np.pi * 120 * t), prf, 24e9)
    found = process(tone, CONFIG, ["stft", "fsst", "image:stft"])
    assert np.all(np.abs(ridge(found["stft"]) - 120) <= 2.5)
    assert found["image:stft"].levels.shape == (32, 32)


def test_recorded_range_bins_and_a_gate() -> None:
    """Of two tones in other bins a gate shows the one within it."""
    prf, t = 1000.0, np.arange(4000) / 1000.0
    bins = np.zeros((64, t.size), complex)
    bins[20], bins[50] = (np.exp(2j * np.pi * f * t) for f in (120, -200))
    recorded = signal(bins, prf, 24e9, 0.25)
    gated = CONFIG.processing.model_copy(update={"range_sum": "gated", "gate_m": 1.0})
    torso = StandingTrack(5.0)
    config = CONFIG.model_copy(update={"processing": gated})
    found = process(recorded, config, ["stft"], torso_track=torso)
    assert np.all(np.abs(ridge(found["stft"]) - 120) <= 2.5)
    beside = np.abs(found["stft"].rows.values + 200) < 20
    assert found["stft"].power[beside].max() < 1e-6 * found["stft"].power.max()


class LessTheMedian(Canceller):
    """What stands still is the median, which a person who moves changes less than the mean."""

    removes_static = True

    def __call__(self, s: Complex) -> Complex:
        return s - (np.median(s.real, axis=-1) + 1j * np.median(s.imag, axis=-1))[..., None]


def test_a_canceller_of_whole_recordings() -> None:
    scene = walking()
    raw = record(scene, ["slow_time"], canceller=Fir((1,)))["slow_time"].x
    found = record(scene, ["signal"], canceller=LessTheMedian())["signal"].x
    expected = LessTheMedian()(raw)
    assert np.linalg.norm(found - expected) < 1e-3 * np.linalg.norm(expected)


def test_another_canceller() -> None:
    """Three pulses instead of two: 4 sin^2 instead of 2 sin, squared, at every Doppler."""
    scene = walking()
    three = record(scene, ["signal"], canceller=Fir((1, -2, 1)))["signal"]
    two = record(scene, ["signal"])["signal"]
    assert three.pulses == two.pulses - 1
    assert three.t[0] == pytest.approx(1 / 500)
    assert np.linalg.norm(three.x - np.diff(two.x)) < 1e-4 * np.linalg.norm(three.x)


def points(signal: Signal) -> Float:
    """As many rows as pulses are stronger than the mean: time (s), power."""
    power = np.abs(signal.x[0, 0]) ** 2
    strong = power > power.mean()
    return np.stack([signal.t[strong], power[strong]], axis=1).astype(np.float32)


def offset_and_noise(scene: Scene, noise: WhiteNoise, w: Waveform) -> tuple[Impairment, ...]:
    return *make_impairments(scene, noise, w), DcOffset()


@pytest.fixture
def own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extensions, "_PRODUCTS", {})


OWN = {
    "a map": Product("range_speed", ("raw_echo", "waveform"), range_speed, "range, Doppler"),
    "its echo": RAW_ECHO,
    "strong_pulses": Product("strong_pulses", ("signal",), points, "strong pulses"),
    "antennas": Product("antennas", ("scene",), lambda s: replace(antennas_of(s), gain=9.0), ""),
    "receiver": Product("receiver", ("scene", "noise", "waveform"), offset_and_noise, "an offset"),
}


@pytest.mark.usefixtures("own")
@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("jobs", [1, 2])
def test_products_of_ones_own_reach_a_data_set(tmp_path: Path, engine: str, jobs: int) -> None:
    """A map, an array with another number of rows a sample, antennas and an impairment, with noise;
    the same with workers, and synthesised anew."""
    for product in OWN.values():
        extensions.add_product(product)
    document = {
        "activities": ["punching", "walking"],
        "samples_per_class": 2,
        "maps": ["stft", "range_speed"],
        "output": {"products": ["strong_pulses"]},
        "engine": {"kind": engine},
        "processing": {"clutter": "none"},
        "snr_db": 20.0,
    }
    config = Config.model_validate(CONFIG.model_dump() | document)
    build(config, tmp_path, jobs, Listener(), batch_size=1)
    scene = draw_valid_scene(config, activity_named("walking"), 1)[0]
    right = record(scene, ["image:range_speed", "strong_pulses"])
    with open_dataset(tmp_path) as data:
        assert np.array_equal(data.maps["range_speed"][3], right["image:range_speed"].levels)
        assert np.array_equal(data.products["strong_pulses"][3], right["strong_pulses"])
        sizes = {len(data.products["strong_pulses"][row]) for row in range(4)}
    assert len(sizes) > 1
    assert not verify(tmp_path, 4).problems
    plain = record(scene, ["stft"], [Product("receiver", (), tuple, "nothing")])["stft"]
    ours = record(scene, ["stft"])["stft"].power.sum(axis=1)
    assert ours.argmax() == len(plain.rows.values) // 2, "the offset is at zero Doppler"


@pytest.mark.usefixtures("own")
def test_a_map_of_ones_own_is_simulated_and_drawn(tmp_path: Path) -> None:
    for product in (RAW_ECHO, OWN["a map"]):
        extensions.add_product(product)
    config = tmp_path / "own.yaml"
    document = CONFIG.model_dump(mode="json", exclude_defaults=True)
    config.write_text(json.dumps(document | {"maps": ["stft", "range_speed"]}))
    for name, more in (("own", ()), ("one", ("--maps", "range_speed"))):
        out = tmp_path / name
        command_line.ok("simulate", config, "-a", "walking", "-o", out, *more)
        with h5py.File(out / "scene.h5") as file:
            assert "range_speed" in file["maps"]
        assert (out / "maps.png").exists()


@pytest.mark.usefixtures("own")
def test_a_data_set_is_read_where_its_products_are_not_known(tmp_path: Path) -> None:
    extensions.add_product(RAW_ECHO)
    extensions.add_product(OWN["a map"])
    config = Config.model_validate(
        CONFIG.model_dump() | {"maps": ["range_speed"], "samples_per_class": 1}
    )
    build(config, tmp_path, 1, Listener())
    extensions._PRODUCTS.clear()
    with open_dataset(tmp_path) as data:
        assert data.maps["range_speed"][0].any()
    with pytest.raises(ValidationError, match="should be 'rtm'"):
        Config.model_validate({"maps": ["range_speed"]})


def scaled(factor: float, signal: Signal) -> Float:
    return factor * np.abs(signal.x[0, 0])


@dataclass(frozen=True)
class Scaled:
    factor: float

    def __call__(self, signal: Signal) -> Float:
        return scaled(self.factor, signal)


@pytest.mark.usefixtures("own")
@pytest.mark.parametrize(
    "makes", [(partial(scaled, 1), partial(scaled, 2)), (Scaled(1), Scaled(2))]
)
def test_two_versions_of_a_product_are_two_data_sets(
    makes: tuple[Callable[..., Float], ...],
) -> None:
    hashes = []
    for make in (*makes, makes[0]):
        extensions.add_product(Product("scaled", ("signal",), make, ""))
        hashes.append(identity_hash(identity(CONFIG)))
    assert hashes[0] == hashes[2] != hashes[1]


@pytest.mark.usefixtures("own")
@pytest.mark.parametrize("name", ["antennas", "receiver"])
def test_a_board_refuses_products_that_it_has_not(name: str) -> None:
    extensions.add_product(OWN[name])
    board = load_config("configs/boards/iwr1443.yaml")
    with pytest.raises(ConfigError, match=f"product {name}: has no effect with radar.cfg"):
        plan_images(board)


@pytest.mark.usefixtures("own")
def test_products_that_cannot_be_stored_are_refused() -> None:
    extensions.add_product(Product("words", (), lambda: "text", ""))
    scene = walking(output=CONFIG.output.model_copy(update={"products": ("words",)}))
    with pytest.raises(SceneError, match="words is str; should be an array"):
        synthesise(scene, plan_images(scene.config), scene.config)
    with pytest.raises(ValueError, match="should be a name"):
        extensions.add_product(Product("a b", (), tuple, ""))


def test_the_commands_import_modules_of_ones_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_radar.py").write_text(
        "from radhar_cli.scene.products.plan import Product\n"
        "from radhar_cli.extensions import add_product\n"
        "add_product(Product('middle', ('signal',), lambda s: s.x[0, 0, 9:19], 'ten pulses'))\n"
    )
    sets = (
        "output.products=[middle]",
        "samples_per_class=1",
        "activities=[walking]",
        "duration_s=1",
    )
    command = ("generate", "configs/smoke.yaml", "-o", tmp_path / "set", "--jobs", 2)
    monkeypatch.setenv("RADHAR_EXTENSIONS", "my_radar")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    done = command_line.process(
        "-m", "radhar_cli", *command, *(x for one in sets for x in ("--set", one))
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        assert file["products/middle"].shape == (10,)
    monkeypatch.setenv("RADHAR_EXTENSIONS", "none_such")
    missing = command_line.process("-m", "radhar_cli", *command)
    assert missing.returncode == 2
    assert "RADHAR_EXTENSIONS: none_such cannot be imported" in missing.stderr
    (tmp_path / "my_radar.py").write_text("def (\n")
    monkeypatch.setenv("RADHAR_EXTENSIONS", "my_radar")
    broken = command_line.process("-m", "radhar_cli", *command)
    assert broken.returncode == 2
    assert "my_radar cannot be imported (SyntaxError: invalid syntax" in broken.stderr


GREETING = '''
"""Greets: the right arm is raised, held, and let down."""

from dataclasses import dataclass
from math import radians
from typing import Annotated, Generic

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.repeating import draw_repetitions
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import ANGLE, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

class GreetingConfig(Section, Generic[B]):
    """How people greet."""

    raised_deg: Annotated[B, ByActivity(ANGLE), People("greeting", 60, 175)] = default_draw(
        uniform(140.0, 170.0)
    )
    """Angle by which the arm of somebody who greets is raised."""

class GreetingTiming(Section, Generic[B]):
    """When people greet."""

    greet_after_s: Annotated[B, ByActivity(ANGLE), People("greeting", 0, 5)] = default_draw(1.0)
    """Time after which somebody greets."""

SECTION, TIMING = GreetingConfig, GreetingTiming

@dataclass(frozen=True)
class Greet:
    """Raises the right arm by an angle (rad) within half a second, and lets it down."""

    duration: float
    angle: float

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest, end = resting_channels(person), begin + self.duration
        steps = [
            Step("right_shoulder", self.angle, begin, 0.5),
            Step("right_shoulder", -self.angle, end - 0.5, 0.5),
        ]
        phases = (Phase(begin, "raising"), Phase(end, "standing"))
        return Planted(person, Course.of(rest, steps), begin, end, phases)

def make_greeting(mover: Mover) -> Greet:
    size = draw_repetitions(mover)[1][0]
    angle = size * radians(mover.numbers(GreetingConfig[float]).raised_deg)
    return Greet(mover.duration, angle)

MOVEMENTS = (
    MovementKind(
        "greeting",
        "stands and greets",
        make_greeting,
        seconds=2.0,
        in_place=True,
        uses=("repeating.size_jitter",),
        words="saying_hello",
    ),
)
'''
WITH_GREETING = """
import sys
from radhar_cli.motion import movements
movements.__path__.append(sys.argv.pop(1))
from radhar_cli.cli import main
for words in " ".join(sys.argv[1:]).split(" then "):
    sys.argv = ["radhar", *words.split()]
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
    print("---")
"""


def test_a_movement_of_people_is_one_file(tmp_path: Path) -> None:
    """Its keys, classes, words and columns are known once it lies beside the others."""
    folder = tmp_path / "movements"
    folder.mkdir()
    (folder / "greeting.py").write_text(GREETING)

    def ran(*arguments: object) -> str:
        done = command_line.process("-c", WITH_GREETING, folder, *arguments)
        assert done.returncode == 0, done.stderr
        return done.stdout

    config = tmp_path / "greeting.yaml"
    config.write_text(
        yaml.safe_dump(
            {
                "classes": {"both": {"sequence": ["greeting", "sitting_down"]}},
                "activities": ["saying_hello", "both"],
                "samples_per_class": 2,
                "duration_s": 3.0,
                "radar": RADAR,
                "image": {"size_px": 32},
                "motion": {"greeting": {"raised_deg": {"uniform": [80, 90]}}},
            }
        )
    )
    show, init = ("config", "show", config), ("config", "init", tmp_path / "all.yaml")
    said = ran(*show, "then", *init, "then", "config", "schema").split("---\n")
    shown = yaml.safe_load(said[0])
    assert shown["motion"]["greeting"] == {"raised_deg": {"uniform": [80.0, 90.0]}}
    assert shown["motion"]["kneeling"]
    assert list(shown["timing"])[-1] == "greet_after_s"
    text = (tmp_path / "all.yaml").read_text()
    assert "Angle by which the arm of somebody who greets is raised." in text
    assert '"GreetingConfig"' in said[2]
    ran("generate", config, "-o", tmp_path / "set", "--jobs", 1)
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        angles = np.degrees(file["scene/raised"][:])
    assert ((angles >= 80) & (angles <= 90)).all()
    refused = command_line.process(
        *("-c", WITH_GREETING, folder, "config", "show", config),
        *("--set", "motion.greeting.raised_deg=20"),
    )
    assert refused.returncode == 2
    assert "motion.greeting.raised_deg = 20" in refused.stderr
    assert "from 60 to 175" in refused.stderr


FAN = """
from dataclasses import dataclass
import numpy as np
from radhar_cli.motion.activities.activity import add_activity

@dataclass(frozen=True)
class Fan:
    place: float
    names, parents, breakpoints, phases, highest_frequency = ("blade",), (None,), (), (), 2.0

    def positions(self, t):
        x = self.place + 0.3 * np.sin(4 * np.pi * t)
        return np.stack([x, np.zeros_like(t), np.full_like(t, 1.5)])[:, None]

    def cross_sections(self, t):
        return np.array([[0.01]])

    torso = positions

def fan(person):
    return Fan(person.place[0])

add_activity("fan", fan)
"""


def test_the_commands_know_activities_of_ones_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_fan.py").write_text(FAN)
    config, data = tmp_path / "fan.yaml", tmp_path / "set"
    config.write_text(
        "activities: [walking, fan]\nsamples_per_class: 1\nduration_s: 1\n"
        "radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}\n"
        "motion: {range_m: 3.0}\nmaps: [stft]\nimage: {size_px: 32}\n"
    )
    monkeypatch.setenv("RADHAR_EXTENSIONS", "my_fan")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    def run(*words: object) -> command_line.Done:
        return command_line.process("-m", "radhar_cli", *words)

    simulate = ("simulate", config, "--activity", "fan", "--no-figures", "-o", tmp_path / "scene")
    for words in (
        ("config", "show", config),
        ("generate", config, "-o", data, "--jobs", 2),
        simulate,
        ("verify", data),
        ("inspect", data),
        ("preview", data, "-o", tmp_path / "preview.png"),
    ):
        done = run(*words)
        assert done.returncode == 0, (words, done.stderr)
    other = FAN.replace("0.3 *", "0.4 *")
    (tmp_path / "my_fan.py").write_text(other)
    refused = run("generate", config, "-o", data)
    assert refused.returncode == 2
    assert "versions.own" in refused.stderr
    assert "Traceback" not in refused.stderr


@pytest.fixture
def own_class(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(activity, "_ADDED", {})
    return add_activity("swinging_ball", swinging).slug


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_class_beyond_the_twelve(own_class: str, tmp_path: Path, jobs: int) -> None:
    config = Config.model_validate(
        CONFIG.model_dump() | {"activities": [own_class, "walking"], "samples_per_class": 2}
    )
    build(config, tmp_path, jobs, Listener(), batch_size=1)
    with h5py.File(tmp_path / "dataset.h5") as file:
        assert list(file["label"]) == [0, 0, 1, 1]
        assert list(file.attrs["class_slugs"]) == [own_class, "walking"]
    assert len(list(tmp_path.glob(f"png/stft/*/{own_class}/*.png"))) == 2


def test_an_own_class_needs_a_new_name(own_class: str) -> None:
    with pytest.raises(ValueError, match="new name"):
        add_activity("walking", swinging)
