"""`--classes FILE`: maps the class names of other data sets to ours."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from radhar_cli.config.documents import read_document
from radhar_cli.errors import ConfigError, FolderError, did_you_mean
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.activities.vocabulary import FROM_FILES, advice_on, meaning_of
from radhar_cli.motion.movements.catalogue import MOVEMENTS


def read_classes(path: Path | None) -> dict[str, str | None]:
    """Read a file of `foreign name: our name`, or `null` for a class to leave out.

    Returns:
        {foreign name: our name, or None}; empty without a file.

    Raises:
        ConfigError: a value is neither a name nor null.
    """
    names = read_document(path)[0] if path else {}
    for foreign, name in names.items():
        if name is not None and (not isinstance(name, str) or not name):
            raise ConfigError(
                f"{path}: {foreign} = {name!r}: should be the name of a class, such as walking, or "
                "null to leave it out"
            )
    return names


def renamed(images: ImageSet, names: Mapping[str, str | None]) -> ImageSet:
    """Images whose classes have the names that `--classes FILE` gives them.

    Raises:
        FolderError: `names` has a class that the images do not have.
    """
    for name in names:
        if name not in images.classes:
            hint = did_you_mean(name, images.classes, f"it has {', '.join(images.classes)}")
            raise FolderError(f"{images.where}: has no class {name!r} (--classes); {hint}")
    return images.renamed(names)


def refuse_mistyped(names: Mapping[str, str | None], known: Sequence[str]) -> None:
    """Refuse names of classes that neither the model nor radhar knows.

    Args:
        images: images of a set, some of whose classes the model may not know.
        names: {foreign name: our name, or None}.
        known: classes of the model.

    Raises:
        ConfigError: one of our names is unknown.
    """
    slugs = (activity.slug for activity in ACTIVITIES)
    accepted = list(dict.fromkeys((*known, *slugs, *MOVEMENTS)))
    for foreign, name in names.items():
        if name is not None and name not in accepted:
            hint = _hint(name, accepted, known)
            raise ConfigError(f"--classes: {foreign} = {name!r}: should be a class or null; {hint}")


def keep_known_classes(images: ImageSet, known: Sequence[str]) -> ImageSet:
    """Images of the classes that a model knows, by another word of the same meaning, too.

    Raises:
        FolderError: it knows none of them.
    """
    images = _by_known_words(images, known)
    unknown = [name for name in images.classes if name not in known]
    if len(unknown) == len(images.classes):
        hint = _hint(unknown[0], known, known)
        others = f", as are the other {len(unknown) - 1}" if unknown[1:] else ""
        raise FolderError(
            f"{images.where}: class {unknown[0]!r} is unknown to the model{others}; {hint}; "
            "--classes FILE maps names"
        )
    return images.renamed(dict.fromkeys(unknown)) if unknown else images


def _by_known_words(images: ImageSet, known: Sequence[str]) -> ImageSet:
    """Images whose classes have the names of a model where these mean the same; a note says so."""
    words = dict[str, str]()
    for name in images.classes:
        slug = None if name in known else meaning_of(name, known)
        if slug is not None and slug not in (*images.classes, *words.values()):
            words[name] = slug
    if not words:
        return images
    pairs = ", ".join(f"{word} is taken for {slug}" for word, slug in words.items())
    note = f"{images.where}: {pairs}; --classes FILE maps names otherwise"
    return replace(images.renamed(words), notes=(*images.notes, note))


def _hint(name: str, accepted: Sequence[str], known: Sequence[str]) -> str:
    """Advise on a name of a class that is not accepted: by meaning, else by known names."""
    listed = f"the model knows {', '.join(known)}"
    advice = advice_on(name, accepted, listed)
    return listed if advice == FROM_FILES else advice


def left_out_message(images: ImageSet, names: Mapping[str, str | None]) -> str | None:
    """Warning of images that are left out as the model does not know their class, None if all stay.

    Args:
        images: images of a set, some of whose classes the model may not know.
        names: {foreign name: our name, or None} of `--classes FILE`; its classes are not warned of.
    """
    excluded = {name: n for name, n in images.left_out.items() if name not in names}
    if not excluded:
        return None
    listed = ", ".join(f"{name} ({n})" for name, n in excluded.items())
    return (
        f"{images.where}: left out {sum(excluded.values())} images of classes that the model does "
        f"not know: {listed}; --classes FILE maps them, or ignores them with null"
    )
