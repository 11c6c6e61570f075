"""The paper's network: convolutions for near pixels, a learned filter of the FFT for far ones.

Source: paper, section IV and its network figure.
"""

import torch
from torch import Tensor, nn

from radhar_cli.errors import ModelError
from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.learning.models.smallnet import Pooled

NAME = "fftnet"
FILTER_SD = 0.02
WIDTHS = (64, 128, 256)
LAST_WIDTH = 512
STRIDE = 32


class GlobalFilter(nn.Module):
    """Layer that multiplies the spectrum of every channel by a learned complex weight.

    ``g(x) = Re IFFT2(K FFT2(x))``. The input is real and only the real part is kept, so K acts as
    its Hermitian part ``H(k) = (K(k) + conj K(-k))/2``, and half a spectrum is enough: ``g(x) =
    IRFFT2(H RFFT2(x))``. (Paper, section IV.A; Rao et al., GFNet, 2021.)

    Attributes:
        weight: [C, H, W, 2], real and imaginary part of K.
    """

    def __init__(self, channels: int, height: int, width: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.randn(channels, height, width, 2) * FILTER_SD)

    def hermitian_half(self) -> Tensor:
        """Effective weight H at the frequencies of RFFT2, complex [C, H, W//2 + 1]."""
        k = torch.view_as_complex(self.weight)
        mirrored = torch.roll(torch.flip(k, (1, 2)), (1, 1), (1, 2))  # K(-k)
        hermitian: Tensor = (k + mirrored.conj()) / 2
        width = self.weight.shape[2]
        # Two columns are all kept, and ONNX has no word for a slice that takes everything.
        return hermitian if width <= 2 else hermitian[:, :, : width // 2 + 1]

    def forward(self, x: Tensor) -> Tensor:
        """Filter [B, C, H, W]; in the precision of the weights, whatever is around it."""
        spectrum = torch.fft.rfft2(x.to(self.weight.dtype))
        filtered: Tensor = torch.fft.irfft2(spectrum * self.hermitian_half(), s=x.shape[-2:])
        return filtered


def convolution(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    """Layers of a 3 x 3 convolution with a bias, batch norm and ReLU, in channels last."""
    layers = nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, padding=1),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )
    layers.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    return layers


class Block(nn.Module):
    """``relu(a(x) b(x) + g(x) + x)``: two convolutional branches, the global filter, the input."""

    def __init__(self, channels: int, height: int, width: int) -> None:
        super().__init__()
        self.a = convolution(channels, channels)
        self.b = convolution(channels, channels)
        self.g = GlobalFilter(channels, height, width)

    def forward(self, x: Tensor) -> Tensor:
        """Output [B, C, H, W] of an input of that shape."""
        return torch.relu(self.a(x) * self.b(x) + self.g(x) + x)


class FFTNet(Pooled):
    """The paper's network, for images of one size, whose sides are multiples of 32.

    6,496,012 parameters at 256 x 256 and 12 classes, six global filters; the last feature maps are
    [B, 512, H/32, W/32].
    """

    def __init__(self, classes: int, height: int, width: int) -> None:
        super().__init__()
        layers: list[nn.Module] = [
            convolution(3, WIDTHS[0], stride=2),
            nn.MaxPool2d(3, stride=2, padding=1),
        ]
        for stage, (channels, wider) in enumerate(
            zip(WIDTHS, (*WIDTHS[1:], LAST_WIDTH), strict=True)
        ):
            size = height // 4 >> stage, width // 4 >> stage
            layers += [Block(channels, *size), Block(channels, *size)]
            layers.append(convolution(channels, wider, stride=2))
        self.layers = nn.Sequential(*layers)
        self.head = nn.Linear(LAST_WIDTH, classes)


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build fftnet for images of (H, W).

    Raises:
        ModelError: a side is no multiple of 32.
    """
    height, width = size
    if height % STRIDE or width % STRIDE:
        raise ModelError(
            f"model {NAME}: images are {height} x {width} px; both sides should be multiples of "
            f"{STRIDE}"
        )
    return FFTNet(outputs.count, height, width)
