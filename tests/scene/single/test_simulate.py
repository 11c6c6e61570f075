"""One scene: its maps, signals and ground truth agree."""

from pathlib import Path

import h5py
import numpy as np
import pytest

import radhar_cli as radhar
from radhar_cli.config import MAP_NAMES, Config, load_config
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.request import map_names, scene_of
from radhar_cli.scene.single.scene_file import describe, write_all
from radhar_cli.scene.single.simulate import Simulation, simulate

ROOT = Path(__file__).resolve().parents[3]
FREE = ROOT / "configs/paper/figures_free_space.yaml"
WALL = ROOT / "configs/paper/figures_through_wall.yaml"
QUICK = ROOT / "configs/quickstart.yaml"


@pytest.fixture(scope="module")
def walking() -> Simulation:
    return simulate(load_config(FREE, ["snr_db=null"]), "walking")


def test_what_a_prompt_shows_fits_a_few_lines(walking: Simulation) -> None:
    for shown in (walking, walking.maps["stft"], walking.truth, walking.maps["stft"].rows):
        assert len(repr(shown)) < 400
    assert set(dir(radhar)) >= {"simulate", "sample", "open_dataset", "__version__"}
    assert not [name for name in dir(radhar) if name.isupper()]


def test_every_product_is_there_with_its_axes(walking: Simulation) -> None:
    pulses = walking.waveform.n_pulses
    assert tuple(walking.maps) == MAP_NAMES
    for one in walking.maps.values():
        assert one.power.shape == (one.rows.values.size, one.columns.values.size)
        assert np.all(np.diff(one.rows.values) > 0)
        assert np.all(np.diff(one.columns.values) > 0)
        assert one.entropy > 0
    assert {signal.x.shape for signal in walking.signals.values()} == {(1, 1, pulses - 1)}
    assert walking.truth.positions.shape == (pulses, 13, 3)
    assert walking.truth.radial_velocity.shape == (pulses, 13)


def test_torso_line_lies_where_its_speed_puts_it(walking: Simulation) -> None:
    """The FSST's strongest bin follows the torso's true Doppler within two bins, late in S8."""
    one = walking.maps["fsst"]
    late = one.columns.values > 1.5
    bin_width = one.rows.values[1] - one.rows.values[0]
    ridge = one.rows.values[np.argmax(one.power[:, late], axis=0)]
    at = np.searchsorted(walking.truth.time, one.columns.values[late])
    truth = walking.truth.doppler[at, JOINTS.index("torso")]
    assert truth.mean() == pytest.approx(-2 * 1.5 * walking.waveform.f0 / SPEED_OF_LIGHT, rel=0.02)
    close = np.abs(ridge - truth) <= 2 * bin_width
    assert close.mean() > 0.9


def test_compensation_centres_the_torso(walking: Simulation) -> None:
    one = walking.maps["fsst_compensated"]
    late = one.columns.values > 1.5
    ridge = one.rows.values[np.argmax(one.power[:, late], axis=0)]
    assert np.mean(np.abs(ridge) <= 2 * (one.rows.values[1] - one.rows.values[0])) > 0.9


@pytest.mark.parametrize("joint", ["right_ankle", "left_elbow", "head"])
@pytest.mark.parametrize("path", [FREE, WALL], ids=["free", "wall"])
def test_ridge_of_a_single_joint_follows_its_true_doppler(path: Path, joint: str) -> None:
    config = load_config(path, ["snr_db=null", "motion.range_m=2"])
    single = simulate(config, "S8", joint=joint, maps=("fsst",))
    one, prf = single.maps["fsst"], single.waveform.prf
    inside = one.columns.values < (2.5 if joint == "right_ankle" else 3.5)  # within the half-band
    ridge = one.rows.values[np.argmax(one.power[:, inside], axis=0)]
    window = round(0.1 * single.waveform.n_pulses)
    doppler = single.truth.doppler[:, JOINTS.index(joint)]
    at = np.searchsorted(single.truth.time, one.columns.values[inside])
    spread = np.array([np.ptp(doppler[max(a - window // 2, 0) : a + window // 2]) for a in at])
    miss = np.abs((ridge - doppler[at] + prf / 2) % prf - prf / 2)
    # Within a window the joint sweeps over `spread`; its ridge lies somewhere on that sweep.
    assert np.all(miss <= spread + 3 * (one.rows.values[1] - one.rows.values[0]))


def test_radial_velocity_is_the_derivative_of_the_path(walking: Simulation) -> None:
    truth, antennas = walking.truth, walking.antennas
    legs = sum(
        np.linalg.norm(truth.positions - np.array(a), axis=2) for a in (antennas.tx, antennas.rx)
    )
    numeric = np.gradient(legs / 2, truth.time, axis=0)
    assert np.abs(numeric - truth.radial_velocity)[1:-1].max() < 1e-3
    assert truth.radial_velocity[:, 0].mean() > 1.3, "walking away is positive"


def test_wall_dims_and_fsst_is_thinner() -> None:
    config = load_config(WALL, ["snr_db=null", "motion.range_m=3", "radar.tx_m=[0.4, -0.1, 1.2]"])
    behind = simulate(config, "S7", maps=("stft", "fsst"))
    through_air = simulate(config.model_copy(update={"wall": None}), "S7", maps=("stft",))
    loss = 10 * np.log10(behind.maps["stft"].power.sum() / through_air.maps["stft"].power.sum())
    assert loss == pytest.approx(-9.8, abs=0.7), "9.80 dB at normal incidence"
    assert behind.maps["fsst"].entropy < behind.maps["stft"].entropy - 0.5


@pytest.mark.parametrize(
    ("activity", "order"),
    [
        ("S9", ["seated", "standing up", "walking"]),
        ("S10", ["walking", "sitting down", "seated"]),
        ("S11", ["lying", "getting up", "walking"]),
        ("S12", ["walking", "falling", "lying"]),
        ("S2", ["punching"]),
        ("S6", ["seated", "standing up"]),
    ],
)
def test_phase_labels_come_in_order(activity: str, order: list[str]) -> None:
    truth = simulate(load_config(WALL), activity, maps=("stft",)).truth
    labels = truth.phase_label
    changes = [truth.phases[n] for n in (labels[0], *labels[1:][np.diff(labels) != 0])]
    assert [name for name in changes if name != "standing"] == order


def test_same_seed_same_scene_as_generate(tmp_path: Path) -> None:
    """Sample 0 of a data set and `simulate` with its seed are one scene, noise included."""
    config = load_config(ROOT / "configs/smoke.yaml", ["seed=5"])
    one = simulate(config.model_copy(update={"seed": 1}), "S4", seed=5, maps=("stft",))
    scene = draw_scene(config, one.activity, 0)
    power = record(scene, ["stft"])["stft"].power
    assert np.array_equal(power, one.maps["stft"].power)


def test_engines_agree_without_noise() -> None:
    direct = load_config(WALL, ["snr_db=null"])
    exact = load_config(WALL, ["snr_db=null", "engine.kind=cube"])
    x, y = (simulate(c, "S3", maps=("stft",)).signals["raw"].x for c in (exact, direct))
    assert np.linalg.norm(x - y) < 1e-3 * np.linalg.norm(x)


def test_only_the_raw_echo_has_static_returns() -> None:
    config = load_config(WALL, ["snr_db=null", "radar.antenna_isolation_db=10"])
    one = simulate(config, "S1", raw=True, maps=("stft",))
    assert one.beat is not None
    assert one.beat.shape == (400, 512)
    assert np.abs(one.beat).mean() == pytest.approx(10 ** (-10 / 20), rel=0.05)
    assert np.abs(np.diff(one.beat, axis=1)).max() < 1e-14
    assert not one.maps["stft"].power.any(), "motionless and noiseless: MTI leaves nothing"


def test_scene_file_holds_it_all(tmp_path: Path) -> None:
    one = simulate(load_config(WALL), "S12")
    write_all(one, tmp_path / "out")
    with h5py.File(tmp_path / "out/scene.h5") as file:
        for name, power_map in one.maps.items():
            stored = file[f"maps/{name}"]
            assert stored.dtype == np.float32
            assert np.allclose(stored[:], power_map.power, rtol=1e-6)
            assert stored.attrs["entropy_bits"] == power_map.entropy
            assert np.array_equal(stored.dims[0][0][:], power_map.rows.values)
            assert np.array_equal(stored.dims[1][0][:], power_map.columns.values)
        assert file["slow_time/compensated"].dtype == np.complex128
        assert file["truth/positions"].shape == (512, 13, 3)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "scene.h5",
        "scene.json",
        "scene.yaml",
    ]
    described = describe(one)
    assert described["parameters"]["wall.eps_r"] == 6
    assert described["entropy_bits"].keys() == set(MAP_NAMES)


def test_nominal_takes_the_middle(tmp_path: Path) -> None:
    config = load_config(ROOT / "configs/paper/through_wall.yaml")
    one = simulate(config, "S2", nominal=True, maps=("stft",))
    assert one.scene.config.motion.range_m == 2
    assert one.scene.config.subject.height_m == pytest.approx(1.7)


def test_what_is_not_asked_for_is_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    one = simulate(load_config(WALL), "S2", maps=("stft",))
    assert set(one.maps) == {"stft"}
    assert not [name for name in one.seconds if name.startswith(("fsst", "levels", "range"))]
    assert one.beat is None


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"activity": "walkin"}, "'walking'"),
        ({"joint": "right_anckle"}, "'right_ankle'"),
        ({"joint": "x"}, "the joints are torso"),
    ],
)
def test_unknown_names_suggest_the_nearest(change: dict[str, str], expected: str) -> None:
    with pytest.raises(ConfigError, match=expected):
        simulate(load_config(WALL), **{"activity": "S1", **change})
    with pytest.raises(ConfigError, match="'fsst'"):
        map_names(["fsts"], load_config(WALL))


def test_too_close_is_refused() -> None:
    config = load_config(WALL, ["wall=null", "motion.range_m=0.4", "radar.tx_m=[0.4, 0, 1.2]"])
    with pytest.raises(SceneError, match=r"torso comes to .*on_invalid: redraw draws such scenes"):
        simulate(config, "S1")


def test_a_scene_is_the_one_of_the_data_set_drawn_again_or_not() -> None:
    config = load_config(QUICK, ["motion.range_m={uniform: [1, 3]}"])
    drawn = [draw_valid_scene(config, activity_named("walking"), index)[0] for index in range(8)]
    index = next(scene.index for scene in drawn if scene.attempt > 0)
    assert simulate(config, "walking", index=index, maps=("stft",)).truth.time.size > 0
    assert scene_of(config, activity_named("walking"), index, nominal=False) == drawn[index]


@pytest.mark.parametrize("config", [str(QUICK), QUICK])
def test_a_config_may_be_a_path(config: str | Path) -> None:
    found = radhar.simulate(config, "punching", maps=("stft",))
    right = simulate(load_config(QUICK), "punching", maps=("stft",))
    assert np.array_equal(found.maps["stft"].power, right.maps["stft"].power)
    with pytest.raises(ConfigError, match=r"no\.yaml: no such file"):
        radhar.simulate("no.yaml", "walking")
    with pytest.raises(ConfigError, match="config = None: should be the path"):
        radhar.simulate(None, "walking")


def test_python_interface(tmp_path: Path) -> None:
    config: Config = radhar.load_config(WALL)
    result = radhar.simulate(config, "walking", 7)
    assert result.maps["stft"].power.ndim == 2
    assert "load_config" in radhar._INTERFACE
    with pytest.raises(AttributeError):
        radhar.nothing  # noqa: B018


def test_figures_of_an_earlier_scene_are_removed(tmp_path: Path, walking: Simulation) -> None:
    for name in ("maps.png", "stickman.gif"):
        (tmp_path / name).write_bytes(b"of another scene")
    write_all(walking, tmp_path)
    assert sorted(p.suffix for p in tmp_path.iterdir()) == [".h5", ".json", ".yaml"]


def test_a_scene_is_written_and_simulated_again(tmp_path: Path) -> None:
    config = load_config("configs/smoke.yaml", ["maps=[rtm, stft]"])
    drawn = simulate(config, "kicking", index=3, maps=("rtm", "stft"))
    written = write_all(drawn, tmp_path)
    scene_yaml = next(path for path in written if path.suffix == ".yaml")
    again = simulate(load_config(scene_yaml), index=3, maps=("rtm", "stft"))
    assert again.scene == drawn.scene
    for name, power_map in drawn.maps.items():
        assert np.array_equal(power_map.power, again.maps[name].power)
