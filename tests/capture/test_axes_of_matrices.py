"""Matrices whose axes nobody has named: what could be transposed is asked for."""

import shlex

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.foreign_targets import profiles, tone
from scipy.io import savemat

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.errors import CaptureError, RadharError

PULSES, BINS = profiles().shape
TONE = ["carrier_hz=24e9", "prf_hz=1000"]
PROFILES = [
    "carrier_hz=7.29e9", "bandwidth_hz=1.5e9", "prf_hz=256", "first_range_m=0.3",
    "range_step_m=0.05144",
]  # fmt: skip
BEAT = [*TONE, "bandwidth_hz=1e9", "adc_rate_hz=1e6"]


def write_matlab73(path, x):
    with h5py.File(path, "w", userblock_size=512) as file:
        values = np.zeros(x.T.shape, [("real", "f8"), ("imag", "f8")])
        values["real"], values["imag"] = x.T.real, x.T.imag
        file["x"] = values
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116))


def write_h5(path, x):
    with h5py.File(path, "w") as file:
        file["x"] = x


WRITERS = {
    "x.npy": np.save,
    "x.npz": lambda path, x: np.savez(path, x=x),
    "x.mat": lambda path, x: savemat(path, {"x": x}),
    "new.mat": write_matlab73,
    "x.h5": write_h5,
}


def answer_question(path, out, keys):
    """Import by the command that the question for keys prints; return (question, samples)."""
    done = radhar("import", path, *(word for key in keys for word in ("--set", key)))
    assert done.returncode == 2
    words = shlex.split(done.stderr.partition("radhar import ")[2].partition("; range")[0])
    ok("import", *words[: words.index("walk.h5")], out)
    with Recording(out) as recording:
        return done.stderr, recording.beat(0, recording.info.pulses)


@pytest.mark.parametrize("name", WRITERS)
def test_profiles_without_axes_are_asked_for_in_every_format(tmp_path, name):
    WRITERS[name](tmp_path / name, profiles())
    question, x = answer_question(tmp_path / name, tmp_path / "out.h5", PROFILES)
    assert f"such as [pulse,sample] if they are {PULSES} pulses x {BINS} samples" in question
    np.testing.assert_allclose(x[0], profiles().T, rtol=1e-6)


@pytest.mark.parametrize("name", WRITERS)
def test_the_command_for_a_bare_matrix_names_its_axes(tmp_path, name):
    for x in (profiles(), profiles().T):
        WRITERS[name](tmp_path / name, x)
        done = radhar("import", tmp_path / name)
        assert done.returncode == 2
        assert done.stderr.count("\n") == 1
        axes = "pulse,sample" if x.shape == (PULSES, BINS) else "sample,pulse"
        assert f"--set axes=[{axes}] -o walk.h5" in done.stderr
        assert "range bins have first_range_m and range_step_m" in done.stderr


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("transposed", [False, True])
def test_no_matrix_is_read_before_its_axes_have_names(tmp_path, name, transposed):
    rng = np.random.default_rng(1)
    x = rng.standard_normal((64, 40)) + 1j * rng.standard_normal((64, 40))
    WRITERS[name](tmp_path / name, x.T if transposed else x)
    with pytest.raises(CaptureError, match=r"has 2 axes.*--set axes="):
        import_capture([tmp_path / name], tmp_path / "out.h5", read_settings(None, BEAT))
    axes = "axes=[pulse,sample]" if transposed else "axes=[sample,pulse]"
    settings = read_settings(None, [*BEAT, axes, "beat=negative"])
    import_capture([tmp_path / name], tmp_path / "out.h5", settings)
    with Recording(tmp_path / "out.h5") as recording:
        np.testing.assert_array_equal(recording.beat(0, 40)[0], x)


@pytest.mark.parametrize("name", WRITERS)
def test_rows_or_columns_are_receivers_of_slow_time_if_axes_say_so(tmp_path, name):
    both = np.stack([tone(), 1j * tone()])
    for x, axes in ((both, "receiver,pulse"), (both.T, "pulse,receiver")):
        WRITERS[name](tmp_path / name, x)
        settings = read_settings(None, [*TONE, f"axes=[{axes}]"])
        import_capture([tmp_path / name], tmp_path / "out.h5", settings)
        with Recording(tmp_path / "out.h5") as recording:
            values = recording.beat(0, recording.info.pulses)
        np.testing.assert_allclose(values[:, 0], both, rtol=1e-6)


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("carrier_hz=7.29", "7.29 GHz is 7.29e9"),
        ("bandwidth_hz=1.5", "should be greater than or equal to 1000 Hz"),
        ("prf_hz=2e8", "should be less than or equal to"),
        ("range_step_m=5.144", "should be at most 3, a number in m: 5 cm is 0.05"),
        ("first_range_m=2000", "should be at most 1000"),
        ("first_range_m=995", "should end at most at 1000 m: both keys are in m"),
    ],
)
def test_numbers_in_another_unit_are_refused(tmp_path, key, says):
    np.save(tmp_path / "x.npy", profiles())
    keys = [*PROFILES, "axes=[pulse,sample]", key]
    with pytest.raises(RadharError) as error:
        import_capture([tmp_path / "x.npy"], tmp_path / "out.h5", read_settings(None, keys))
    assert says in str(error.value)
    assert not (tmp_path / "out.h5").exists()
