"""Write docs/reference/python.md, the Python interface, out of its docstrings.

python scripts/python_page.py
"""

import inspect
import re
from importlib import import_module
from pathlib import Path
from typing import Any

import radhar_cli

PAGE = Path(__file__).resolve().parents[1] / "docs/reference/python.md"
HEAD = """# Python

After this page you can build data sets, train and evaluate networks, simulate scenes and read data from Python.

`import radhar` provides the names of the first sections. Import the classes that they return, and the functions that add your
own parts ([architecture](architecture.md#to-add-x-write-y)), from the modules shown.

A sweep over the signal-to-noise ratio:

```python
import radhar

config = radhar.load_config("quickstart").replace({"samples_per_class": 10, "image.size_px": 32})
for snr_db in (30, 10):
    radhar.generate(config.replace(snr_db=snr_db), f"sweep/{snr_db}dB")
radhar.train("sweep/30dB", "sweep/run", {"epochs": 2})
evaluated = radhar.evaluate("sweep/run", ["sweep/30dB", "sweep/10dB"])
print(evaluated.scores["accuracy"])
```

The network that this trained, called on an array as the data set has it (grey levels, drawn in the colours of its pictures), and asked
about a data set, whose answers go to a file:

```python
import radhar

run = radhar.load_run("sweep/run", device="cpu")
print(run.target, run.classes, run.input_shape, run.units)
with radhar.open_dataset("sweep/10dB") as data:
    levels = data.maps[run.metadata.map][:8]  # uint8 [8, H, W]
probabilities = run(levels)  # [8, classes]
print([run.classes[number] for number in probabilities.argmax(1)])
found = run.predict("sweep/10dB", split="val")
print(found.samples[0], found.likeliest[0])
found.write("sweep/found.csv")
```
"""
SECTIONS = {
    "Configs and data sets": (
        *("load_config", "load_radars", "radhar_cli.config.data_set.Config.replace"),
        *("generate", "audit", "simulate", "sample", "open_dataset"),
    ),
    "Networks": ("train", "evaluate", "load_run"),
    "Feed PyTorch": ("Samples", "Sequences", "torch_dataset"),
    "What they return": (
        "radhar_cli.learning.trained_run.TrainedRun",
        "radhar_cli.learning.interface.EvaluatedRuns",
        "radhar_cli.learning.estimates.RunEstimates",
        "radhar_cli.scene.single.simulate.Simulation",
        "radhar_cli.processing.power_map.PowerMap",
        "radhar_cli.dataset.reading.Dataset",
    ),
    "Parts of your own": (
        "radhar_cli.motion.activities.activity.add_activity",
        "radhar_cli.extensions.add_product",
        "radhar_cli.scene.products.run.record",
        "radhar_cli.scene.products.run.process",
    ),
}
LINE = 100  # characters of a signature


def page() -> str:
    """Text of the page."""
    lines = [HEAD]
    for heading, names in SECTIONS.items():
        lines.append(f"## {heading}\n")
        for name in names:
            lines += describe(name)
    return "\n".join(lines).rstrip() + "\n"


def describe(name: str) -> list[str]:
    """Heading, signature and docstring of a function or class, and those of its methods."""
    if "." not in name:
        return [f"### radhar.{name}\n", *_describe(name, getattr(radhar_cli, name))]
    value, parts = None, name.split(".")
    for cut in range(len(parts) - 1, 0, -1):
        try:
            value = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for part in parts[cut:]:
            value = getattr(value, part)
        break
    return [f"### {name}\n", *_describe(parts[-1], value)]


def _describe(name: str, value: Any) -> list[str]:
    lines = [*_signature(name, value), *_text(inspect.getdoc(value) or "")]
    if inspect.isclass(value):
        for member, method in vars(value).items():
            is_property = isinstance(method, property)
            if member.startswith("_") or not (is_property or inspect.isfunction(method)):
                continue
            first, *rest = _text(inspect.getdoc(getattr(value, member)) or "")
            call = member if is_property else f"{member}{_arguments(method)}"
            lines += [f"**`{call}`** {first}", *rest]
    return lines


def _signature(name: str, value: Any) -> list[str]:
    return ["```py", f"{name}{_arguments(value)}", "```\n"]


def _arguments(value: Any) -> str:
    """Arguments of a function with their types, as they stand in the sources, and its result."""
    signature = inspect.signature(value)
    wanted = [one for one in signature.parameters.values() if one.name != "self"]
    text = str(signature.replace(parameters=wanted))
    text = re.sub(r"\b(?:[a-z_]+\.)+([A-Z]\w*)", r"\1", text).replace("'", "")
    text = re.sub(r"<(?:class )?([\w.]+)[^>]*>", r"\1", text)
    if len(text) <= LINE:
        return text
    inner, _, result = text.removeprefix("(").rpartition(") -> ")
    rows = re.split(r", (?=\*,|\*{0,2}\w+(?::|=|,|$))", inner)
    return "(\n    " + ",\n    ".join(rows) + f",\n) -> {result}"


def _text(docstring: str) -> list[str]:
    """Docstring as Markdown: its sections are lists."""
    lines = list[str]()
    for paragraph in docstring.split("\n\n"):
        head, _, rest = paragraph.partition("\n")
        if head in ("Args:", "Attributes:", "Raises:", "Returns:", "Yields:"):
            entries = re.sub(r"\n {8,}", " ", "\n" + rest).strip("\n").split("\n")
            shown = [re.sub(r"^ +([\w, *]+): ", r"- `\1`: ", entry) for entry in entries]
            shown = [entry if entry.startswith("- ") else entry.strip() for entry in shown]
            lines += [head.removesuffix(":") + ":\n", *shown, ""]
        else:
            lines += [paragraph, ""]
    return lines


def main() -> None:
    """Write the page."""
    PAGE.write_text(page())


if __name__ == "__main__":
    main()
