"""What the global filters pass, by spatial frequency."""

import numpy as np
import pytest
import torch

from radhar_cli.learning.filter_weights import filter_magnitudes, filter_table
from radhar_cli.learning.models.fftnet import FFTNet, GlobalFilter


@pytest.mark.parametrize("size", [(8, 8), (4, 6), (5, 7), (6, 5), (2, 2), (1, 4), (3, 1)])
def test_magnitude_is_that_of_the_whole_hermitian_part(size):
    layer = GlobalFilter(3, *size)
    k = torch.view_as_complex(layer.weight).detach().numpy()
    rows, columns = (-np.arange(n) % n for n in size)
    hermitian = (k + k[:, rows][:, :, columns].conj()) / 2
    (found,) = filter_magnitudes(torch.nn.Sequential(layer))
    np.testing.assert_allclose(found, np.abs(hermitian).mean(0), rtol=1e-5, atol=1e-8)


def test_network_has_six():
    found = filter_magnitudes(FFTNet(3, 64, 32))
    assert [f.shape for f in found] == [(16, 8)] * 2 + [(8, 4)] * 2 + [(4, 2)] * 2


def test_flat_filter_prefers_nothing_and_one_line_is_concentrated():
    flat, line = np.ones((16, 16)), np.zeros((16, 16))
    line[0, 0] = 2.0
    one, two = filter_table([flat, line])
    assert one["low_gain"] == pytest.approx(1.0)
    assert one["concentration"] == pytest.approx(0.0)
    assert two["low_gain"] == pytest.approx(256 / 9), "|f| < 1/8: three lines of sixteen"
    assert (two["concentration"], two["largest"]) == (1.0, 2.0)
    assert (one["filter"], two["filter"]) == (1, 2)
    assert (one["mean"], two["mean"]) == (1.0, 2 / 256)
