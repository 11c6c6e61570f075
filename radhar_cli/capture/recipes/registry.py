"""The recipes by name, and sets that are refused."""

from importlib import import_module

from radhar_cli.capture.recipes.recipe import SetRecipe
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.extensions import load_extensions

# {name: module that has it as RECIPE}; a module of RADHAR_EXTENSIONS may add to it.
RECIPES = {
    "glasgow": "radhar_cli.capture.recipes.glasgow",
    "mars": "radhar_cli.capture.recipes.mars",
    "radhar": "radhar_cli.capture.recipes.radhar",
    "mhomeges": "radhar_cli.capture.recipes.mhomeges",
    "mmfi": "radhar_cli.capture.recipes.mmfi",
    "unimmhar": "radhar_cli.capture.recipes.unimmhar",
    "points": "radhar_cli.capture.recipes.points",
    "images": "radhar_cli.capture.recipes.images",
}
PICKLES = "is published as pickles, which run code when they are opened: {}"
REFUSED = {
    "milipoint": PICKLES.format("convert them where you trust them, then use `points`"),
    "darkszchao": PICKLES.format("convert them where you trust them, then use `points`"),
    "mri": PICKLES.format("its clips without pickles are in unimmhar"),
}


def find_recipe(name: str) -> SetRecipe:
    """Find the recipe of a name.

    Raises:
        ConfigError: there is none, or the set is refused.
    """
    load_extensions()
    plain = name.strip().lower().replace("-", "").replace("_", "")
    if plain in REFUSED:
        raise ConfigError(f"{name}: {REFUSED[plain]}")
    if plain not in RECIPES:
        hint = did_you_mean(plain, RECIPES, f"there are {', '.join(RECIPES)}")
        raise ConfigError(f"{name}: there is no such recipe; {hint}")
    recipe: SetRecipe = import_module(RECIPES[plain]).RECIPE
    return recipe


def every_recipe() -> dict[str, SetRecipe]:
    """Recipes by name."""
    load_extensions()
    return {name: find_recipe(name) for name in RECIPES}
