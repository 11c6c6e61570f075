"""Windows over the samples of a chirp."""

from typing import get_args

import numpy as np
import pytest
from scipy.signal import windows

from radhar_cli.radar.chirp_window import ChirpWindow, WindowName

C = 299792458.0
NAMES = get_args(WindowName)
TEXTBOOK = {
    "rectangular": windows.boxcar,
    "hann": windows.hann,
    "hamming": windows.hamming,
    "blackman": windows.blackman,
    "blackmanharris": windows.blackmanharris,
    "taylor": lambda n: windows.taylor(n, 8, 45),
    "chebyshev": lambda n: windows.chebwin(n, 45),
}


@pytest.mark.parametrize("samples", [3, 64, 401])
@pytest.mark.parametrize("name", NAMES)
def test_windows_are_those_of_the_textbook_with_the_energy_of_none(name, samples):
    weights = ChirpWindow(name, 45.0).weights(samples)
    shape = TEXTBOOK[name](samples)
    assert np.sum(weights**2) == pytest.approx(samples, rel=1e-12)
    assert weights == pytest.approx(shape / np.sqrt(np.mean(shape**2)), abs=1e-9)
    assert weights == pytest.approx(weights[::-1], abs=1e-9)


@pytest.mark.parametrize(
    ("name", "loss_db"),
    [("rectangular", 0.0), ("hann", 1.76), ("hamming", 1.34), ("blackman", 2.37)],
)
def test_what_a_window_costs_is_what_harris_tabulates(name, loss_db):
    """Equivalent noise bandwidths of 1, 1.5, 1.36 and 1.73 bins."""
    loss = -10 * np.log10(ChirpWindow(name).gain(4096) / 4096)
    assert loss == pytest.approx(loss_db, abs=0.02)


@pytest.mark.parametrize(
    ("name", "level"), [("hann", -31.4), ("hamming", -40), ("taylor", -44.5), ("chebyshev", -44.9)]
)
def test_sidelobes_are_as_low_as_they_are_said_to_be(name, level):
    spectrum = np.abs(np.fft.rfft(ChirpWindow(name, 45.0).weights(200), 2**14))
    below = np.argmax(np.diff(spectrum) > 0)  # where the main lobe ends
    assert 20 * np.log10(spectrum[below:].max() / spectrum[0]) <= level


def test_few_samples_have_no_window():
    assert ChirpWindow("hann").weights(2).tolist() == [1, 1]
