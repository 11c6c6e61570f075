"""Random configs for the fuzz test: every key, the extremes included, valid and broken.

The ranges are those of docs/reference/limits.md, ends included, so that a document made here is
refused only for what spans several keys; `Drawer.broken` then spoils one key.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from helpers.movements import in_groups
from pydantic import BaseModel

from radhar_cli.config import MAP_NAMES, Config
from radhar_cli.config.checks.people import HUMAN_LIMITS
from radhar_cli.motion.activities.activity import ACTIVITIES

Document = dict[str, Any]
_, MAX_SECONDS = HUMAN_LIMITS["duration_s"]


def dotted_keys(model: type[BaseModel] = Config, prefix: str = "") -> Iterator[str]:
    """Every key of the config."""
    for name, field in model.model_fields.items():
        kinds = [field.annotation, *getattr(field.annotation, "__args__", ())]
        inner = next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), None)
        yield prefix + name
        if inner is not None and not is_number(inner):
            yield from dotted_keys(inner, f"{prefix}{name}.")


def is_number(model: type[BaseModel]) -> bool:
    """Whether this is a form of a number of a scene, and no section."""
    return model.__module__.endswith(".number")


KEYS = tuple(dict.fromkeys(dotted_keys()))

# Nothing that any key takes, besides what a key of its own kind would refuse.
JUNK: tuple[Any, ...] = (
    "fast",
    "",
    "1e",
    [],
    [1],
    [1, 2, 3, 4],
    {},
    {"uniform": [2, 1]},
    {"uniform": [1]},
    {"normal": [0, -1]},
    {"normal": [1, 1], "min": 50},
    {"choice": []},
    {"vary": [1, 2]},
    {"uniform": [0, 1], "vary": [1, 0.1]},
    {"per_activity": {"walking": 1}},
    {"per_activity": {"default": "x"}},
    {"per_activity": {"default": 1, "flying": 2}},
    {"zzz": 1},
    float("nan"),
    float("inf"),
    -float("inf"),
    1e308,
    -1e308,
    1e31,
    -1,
    -1e-9,
    0,
    5e-324,
    10**400,
    2**63,
    True,
    None,
    0.5,
)


class Drawer:
    """Draws documents from one generator; sizes are kept small, nothing else is."""

    def __init__(self, seed: int, block: int) -> None:
        self.rng = np.random.default_rng([seed, block])

    def chance(self, p: float) -> bool:
        return bool(self.rng.random() < p)

    def pick(self, choices: Any) -> Any:
        return choices[int(self.rng.integers(len(choices)))]

    def log(self, low: float, high: float) -> float:
        """Log-uniform, and now and then an end of the range itself."""
        if self.chance(0.05):
            return self.pick((low, high))
        value = 10 ** self.rng.uniform(np.log10(low), np.log10(high))
        return float(min(max(value, low), high))

    def signed(self, low: float, high: float) -> float:
        return self.pick((-1.0, 1.0)) * self.log(low, high)

    def number(self, draw: Any) -> Any:
        """A number of a scene in any of its forms, all of whose draws `draw` could have made."""
        kind = self.rng.random()
        value = draw()
        if kind < 0.6:
            return value
        low, high = sorted((value, draw()))
        if kind < 0.7:
            return {"uniform": [low, high]}
        if kind < 0.8:
            return {"choice": [value, draw(), draw()]}
        if kind < 0.9:
            sd = max(high - low, abs(low) * 1e-3, 1e-9)
            return {"normal": [low, sd], "min": low, "max": high}
        middle = 0.5 * (low + high)
        return {"vary": [middle, 0.9 * min((high - middle) / abs(middle), 1) if middle else 0]}

    def by_activity(self, draw: Any) -> Any:
        if self.chance(0.8):
            return self.number(draw)
        names = [self.pick(ACTIVITIES).slug for _ in range(2)]
        return {
            "per_activity": {
                "default": self.number(draw),
                **{name: self.number(draw) for name in names},
            }
        }

    def maybe(self, document: Document, p: float, key: str, draw: Any) -> None:
        if self.chance(p):
            document[key] = draw()

    def document(self) -> Document:
        """One config that ought to be valid: every key there now and then, sizes small."""
        pulses, samples = int(self.rng.integers(24, 260)), int(self.rng.integers(2, 24))
        radar = self.radar(samples)
        document: Document = {
            "seed": int(self.rng.integers(0, 2**63)),
            "duration_s": pulses / radar["prf_hz"],
            "samples_per_class": int(self.rng.integers(1, 50)),
            "radar": radar,
            "image": {"size_px": self.pick((16, 32, [16, 24], [31, 17]))},
            "processing": self.processing(pulses, samples, radar["prf_hz"]),
            "engine": {"kind": self.pick(("direct", "cube"))},
        }
        engine = document["engine"]
        self.maybe(engine, 0.3, "precision", lambda: "double")
        self.maybe(engine, 0.3, "fallback", lambda: self.pick(("refuse", "cube")))
        self.maybe(engine, 0.3, "tolerance_db", lambda: -self.log(6, 400))
        if engine["kind"] == "cube":
            self.maybe(engine, 0.3, "motion_in_chirp", lambda: True)
        self.maybe(document, 0.7, "activities", lambda: [self.pick(ACTIVITIES).slug])
        self.maybe(document, 0.7, "motion", self.motion)
        self.maybe(document, 0.6, "timing", lambda: self.timing(document["duration_s"]))
        self.maybe(document, 0.6, "subject", self.subject)
        if document["duration_s"] <= MAX_SECONDS and self.chance(0.4):
            self.people(document)
        self.maybe(document, 0.3, "body", self.body)
        self.maybe(document, 0.5, "wall", self.wall)
        self.maybe(document, 0.6, "snr_db", lambda: self.number(lambda: self.signed(1e-3, 300)))
        self.maybe(document, 0.2, "snr_db", lambda: None)
        self.maybe(document, 0.3, "snr_reference", lambda: self.pick(("free_space", "received")))
        document["on_invalid"] = "keep"  # redrawing would refuse half of them
        self.maybe(document, 0.1, "on_invalid", lambda: self.pick(("keep", "error", "redraw")))
        self.maybe(document, 0.5, "maps", self.maps)
        self.maybe(document["image"], 0.4, "dynamic_range_db", lambda: self.log(1e-300, 300))
        self.maybe(document["image"], 0.1, "colour_map", lambda: self.pick(("gray", "turbo")))
        self.maybe(document["image"], 0.2, "cfar", self.cfar)
        if "cfar" in document["image"]:
            document["image"]["kind"] = "cfar"
        self.maybe(document, 0.1, "output", lambda: {"png": False, "hdf5_level": 9})
        self.maybe(document, 0.1, "split", lambda: {"by": "subject", "subjects": 1, "test": 0.0})
        return document

    def cfar(self) -> Document:
        """Windows that fit into the smallest image there is, 16 pixels."""
        guard = [int(n) for n in self.rng.integers(0, 4, 2)]
        cfar: Document = {
            "guard": guard,
            "training": [int(self.rng.integers(1, 8 - max(guard)))] * 2,
        }
        cfar["pfa"] = self.number(lambda: self.log(1e-12, 0.999))
        self.maybe(cfar, 0.5, "floor_db", lambda: self.number(lambda: self.log(1e-3, 200)))
        self.maybe(cfar, 0.5, "domain", lambda: "power")
        self.maybe(cfar, 0.5, "edges", lambda: "shrink")
        return cfar

    def maps(self) -> list[str]:
        return [name for name in MAP_NAMES if self.chance(0.4)] or ["fsst"]

    def radar(self, samples: int) -> Document:
        prf = self.log(1e-3, 1e7) if self.chance(0.5) else self.log(100, 1e4)
        chirp = self.log(max(1e-12, 1e-4 / prf), min(1e4, 0.9 / prf))
        radar: Document = {
            "prf_hz": prf,
            "chirp_s": chirp,
            "adc_rate_hz": min(samples / chirp, 1e13),
        }
        self.maybe(radar, 0.7, "carrier_hz", lambda: self.number(lambda: self.log(1e6, 1e13)))
        self.maybe(radar, 0.7, "bandwidth_hz", lambda: self.number(lambda: self.log(1e3, 1e12)))
        for key in ("tx_m", "rx_m"):
            self.maybe(radar, 0.3, key, lambda: [self.signed(1e-6, 1e6) for _ in range(3)])
        for key, most in (("antenna_gain_dbi", 150), ("antenna_isolation_db", 300)):
            draw = lambda most=most: self.signed(1e-3, most)  # noqa: E731
            self.maybe(radar, 0.3, key, lambda draw=draw: self.number(draw))
        self.maybe(radar, 0.3, "residual_video_phase", lambda: self.chance(0.5))
        return radar

    def processing(self, pulses: int, samples: int, prf: float) -> Document:
        share = float(self.rng.uniform(9 / pulses, 0.96))
        processing: Document = {"window_s": share * pulses / prf}
        self.maybe(processing, 0.5, "overlap_fraction", lambda: float(self.rng.uniform(0, 0.999)))
        self.maybe(processing, 0.3, "clutter", lambda: "none")
        self.maybe(
            processing, 0.3, "range_fft_length", lambda: 2 * int(self.rng.integers(samples, 64))
        )
        self.maybe(processing, 0.2, "fsst_hop_pulses", lambda: int(self.log(1, 1e6)))
        self.maybe(processing, 0.3, "range_reference", lambda: self.pick(("centre", "start")))
        self.maybe(processing, 0.3, "stft_fft_length", lambda: int(self.rng.integers(pulses, 300)))
        self.maybe(
            processing,
            0.3,
            "fsst_threshold",
            lambda: self.pick((0.0, self.log(1e-300, 0.999))),
        )
        order = int(self.rng.integers(0, 31))
        frame = order + 1 + order % 2 + 2 * int(self.rng.integers(0, 20))
        self.maybe(processing, 0.3, "savgol", lambda: {"order": order, "frame": frame})
        return processing

    def motion(self) -> Document:
        motion: Document = {"model": "paper"}
        extreme = self.chance(0.5)
        for key in ("range_m", "cross_range_m"):
            far = (lambda: self.signed(1e-3, 1e6)) if extreme else (lambda: self.log(0.5, 20))
            self.maybe(motion, 0.5, key, lambda far=far: self.by_activity(far))
        for key in ("angle_deg", "thigh_deg", "calf_deg", "arm_deg", "turn_deg"):
            self.maybe(motion, 0.4, key, lambda: self.by_activity(lambda: self.signed(1e-12, 360)))
        self.maybe(motion, 0.4, "speed_mps", lambda: self.by_activity(lambda: self.log(1e-9, 1e4)))
        self.maybe(motion, 0.4, "gait_hz", lambda: self.by_activity(lambda: self.log(1e-9, 1e3)))
        for key in ("speed_mps", "gait_hz"):
            self.maybe(motion, 0.1, key, lambda: 0)
        return in_groups(motion)

    def people(self, document: Document) -> None:
        """Make the document one of people: what they use within what people do."""
        sections: dict[str, Document] = {"subject": {}, "motion": {"model": "human"}, "timing": {}}
        for key, (low, high) in HUMAN_LIMITS.items():
            section, _, name = key.rpartition(".")
            if section:
                draw = lambda low=low, high=high: float(self.rng.uniform(low, high))  # noqa: E731
                inner: Document = sections
                for part in section.split("."):
                    inner = inner.setdefault(part, {})
                self.maybe(inner, 0.4, name, lambda draw=draw: self.number(draw))
        fall = self.pick(("sideways", {"choice": ["forward", "backward", "sideways"]}))
        falling = sections["motion"].setdefault("falling", {})
        self.maybe(falling, 0.4, "direction", lambda: fall)
        for section, numbers in sections.items():
            document[section] = document.get(section, {}) | numbers
        for key in HUMAN_LIMITS:  # what was drawn for the paper's model is no people's
            section, _, name = key.rpartition(".")
            drawn, inner = sections, document
            for part in filter(None, section.split(".")):
                drawn, inner = drawn.get(part, {}), inner.get(part, {})
            if section and name not in drawn:
                inner.pop(name, None)
        self.maybe(
            document, 0.4, "people", lambda: [self.other() for _ in range(self.pick((1, 2)))]
        )

    def other(self) -> Document:
        """Somebody else in the scene."""
        other: Document = {"activity": self.pick(ACTIVITIES).slug, "motion": {}}
        self.maybe(other, 0.3, "share", lambda: float(self.rng.uniform(0, 1)))
        for key in ("range_m", "cross_range_m"):
            draw = lambda: self.signed(1e-3, 100)  # noqa: E731
            self.maybe(other["motion"], 0.8, key, lambda draw=draw: self.number(draw))
        self.maybe(other, 0.3, "subject", lambda: {"height_m": float(self.rng.uniform(1.5, 2.1))})
        return other

    def timing(self, duration: float) -> Document:
        keys = ("seat_start", "seat_duration", "rise_start", "rise_duration", "walk_start")
        keys += ("walk_stop", "sit_duration", "fall_duration", "blend")
        timing: Document = {}
        for key in keys:
            near = lambda: min(duration * float(self.rng.random()), 1e7)  # noqa: E731
            draw = near if self.chance(0.6) else lambda: self.log(1e-12, 1e7)
            self.maybe(timing, 0.5, f"{key}_s", lambda draw=draw: self.by_activity(draw))
            self.maybe(timing, 0.1, f"{key}_s", lambda: 0)
        return timing

    def subject(self) -> Document:
        subject: Document = {}
        self.maybe(subject, 0.7, "height_m", lambda: self.number(lambda: self.log(0.1, 10)))
        self.maybe(subject, 0.5, "weight_kg", lambda: self.number(lambda: self.log(1e-3, 1e6)))
        return subject

    def body(self) -> Document:
        body: Document = {"scatterers": self.pick(("points", "segments"))}
        self.maybe(body, 0.7, "points_per_segment", lambda: int(self.rng.integers(1, 25)))
        self.maybe(body, 0.5, "shadowing", lambda: self.chance(0.5))
        return body

    def wall(self) -> Document:
        wall: Document = {}
        extreme = self.chance(0.4)
        self.maybe(wall, 0.7, "eps_r", lambda: self.number(lambda: self.log(1, 1e6)))
        self.maybe(wall, 0.7, "loss_tangent", lambda: self.number(lambda: self.log(1e-12, 1e12)))
        self.maybe(wall, 0.1, "loss_tangent", lambda: 0)
        self.maybe(wall, 0.4, "rays", lambda: self.pick(("straight", "plane", "refracted")))
        fresnel = ("normal", "perpendicular", "parallel")
        self.maybe(wall, 0.4, "fresnel", lambda: self.pick(fresnel))
        if extreme:
            wall["size_m"] = [self.log(1e-6, 1e6) for _ in range(3)]
            wall["center_m"] = [self.signed(1e-6, 1e6) for _ in range(3)]
        return wall

    def broken(self) -> tuple[Document, str]:
        """A document with one key replaced by junk, or one too many; and that key."""
        document = self.document()
        if self.chance(0.15):
            place = self.pick(("", "radar.", "motion.", "processing.savgol.", "wall."))
            key = place + self.pick(("zzz", "carier_hz", "seeed"))
        else:
            key = self.pick(KEYS)
        *parents, last = key.split(".")
        place: Any = document
        for name in parents:
            if not isinstance(place.get(name), dict):
                place[name] = {}
            place = place[name]
        place[last] = self.signed(1e-320, 1e308) if self.chance(0.3) else self.pick(JUNK)
        return document, key
