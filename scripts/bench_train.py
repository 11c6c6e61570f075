"""What each shortcut of a training step buys, as ratios of one run.

    python scripts/bench_train.py [--px 128] [--batch 32] [--rounds 3]

Every variant runs in a process of its own, in turn, and the rounds are interleaved; printed are the
median step and its spread, and the ratio to the step as `radhar train` does it.
"""

import argparse
import statistics
import subprocess
import sys

VARIANTS = {
    "as radhar train does it": (),
    "full complex FFT instead of rfft2": ("complex",),
    "the other precision": ("precision",),
}
STEPS = 4

STEP = """
import sys, time, torch
from torch.nn.functional import cross_entropy
from radhar_cli.learning import machine
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.models.fftnet import GlobalFilter
px, batch, steps, *without = sys.argv[1:]
px, batch, steps = int(px), int(batch), int(steps)
if "complex" in without:
    def full(self, x):
        k = torch.view_as_complex(self.weight)
        return torch.fft.ifft2(torch.fft.fft2(x.to(self.weight.dtype)) * k).real
    GlobalFilter.forward = full
device = machine.choose_device("auto")
precision = machine.choose_precision("auto", device)
if "precision" in without:
    precision = torch.float32 if precision == torch.bfloat16 else torch.bfloat16
torch.manual_seed(0)
model = build_model("fftnet", 12, (px, px)).to(device)
optimiser = torch.optim.Adam(model.parameters(), 1e-3)
x = torch.randn(batch, 3, px, px, device=device)
y = torch.randint(12, (batch,), device=device)
times = []
for _ in range(steps):
    start = time.perf_counter()
    with machine.autocast(device, precision):
        logits = model(x)
    cross_entropy(logits.float(), y).backward()
    optimiser.step()
    optimiser.zero_grad()
    if device.type == "cuda":
        torch.cuda.synchronize()
    times.append(time.perf_counter() - start)
print(device.type, str(precision).removeprefix("torch."), *times[1:])
"""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--px", type=int, default=128)
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    times: dict[str, list[float]] = {name: [] for name in VARIANTS}
    kinds = {}
    for _ in range(asked.rounds):
        for name, without in VARIANTS.items():
            line = [sys.executable, "-c", STEP, asked.px, asked.batch, STEPS, *without]
            done = subprocess.run(list(map(str, line)), capture_output=True, text=True, check=True)
            device, precision, *steps = done.stdout.split()
            kinds[name] = f"{device}, {precision}"
            times[name] += map(float, steps)
    own = statistics.median(next(iter(times.values())))
    print(f"fftnet, {asked.px} x {asked.px} px, batch {asked.batch}; {asked.rounds} rounds")
    for name, found in times.items():
        middle = statistics.median(found)
        print(
            f"{name:<36} {kinds[name]:<14} {middle:7.3f} s a step "
            f"({min(found):.3f} to {max(found):.3f})  ratio {middle / own:.2f}"
        )


if __name__ == "__main__":
    main()
