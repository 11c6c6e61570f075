"""The error of a setting in one scene: against exact data of the same scene, without noise."""

from typing import Any, NamedTuple

from radhar_cli.arrays import Complex, Float, Levels
from radhar_cli.echo.direct import Accuracy
from radhar_cli.pipeline.run import record
from radhar_cli.tradeoff.measures import image_scores, map_error_db, relative_db
from radhar_cli.tradeoff.scenes import Scenes
from radhar_cli.tradeoff.settings import Setting

QUIET = "snr_db=null"


class Sample(NamedTuple):
    """One scene under one setting.

    Attributes:
        signal: x [M] after the canceller.
        power: the first map of the config.
        levels: its image.
        dynamic_range_db: of the image.
        engine_db: the error that the direct engine measured itself, dB; None of the cube.
    """

    signal: Complex
    power: Float
    levels: Levels
    dynamic_range_db: float
    engine_db: float | None


class SceneDifferences:
    """All settings in one scene; what several of them refer to is made once."""

    def __init__(self, scenes: Scenes, slug: str) -> None:
        self._scenes, self._slug = scenes, slug
        self._made: dict[tuple[str, ...], Sample] = {}

    def of(self, setting: Setting) -> dict[str, Any]:
        """How far the setting's data are from its reference, in numbers that JSON can hold."""
        quiet = () if setting.noisy else (QUIET,)
        compared = self._sample((*setting.compared, *quiet))
        right = self._sample((*setting.exact, *quiet))
        row: dict[str, Any] = {}
        if compared.signal.shape == right.signal.shape:
            row["signal_error_db"] = relative_db(compared.signal, right.signal)
        if compared.power.shape == right.power.shape:
            error, worst = map_error_db(compared.power, right.power, right.dynamic_range_db)
            row |= {"map_error_db": error, "map_error_max_db": worst}
        return (
            row
            | image_scores(compared.levels, right.levels)
            | {"measured_error_db": compared.engine_db}
        )

    def _sample(self, overrides: tuple[str, ...]) -> Sample:
        if overrides not in self._made:
            self._made[overrides] = self._make(overrides)
        return self._made[overrides]

    def _make(self, overrides: tuple[str, ...]) -> Sample:
        config = self._scenes.config(overrides)
        name = config.maps[0]
        asked = ["signal", name, f"image:{name}"]
        if config.engine.kind == "direct":
            asked.append("accuracy")
        scene = self._scenes.draw(self._slug, config)
        products = record(scene, asked).products
        accuracy = products.get("accuracy")
        measured = accuracy.error_db if isinstance(accuracy, Accuracy) else None
        return Sample(
            products["signal"].x[0, 0],
            products[name].power,
            products[f"image:{name}"].levels,
            config.image.dynamic_range_db,
            measured,
        )
