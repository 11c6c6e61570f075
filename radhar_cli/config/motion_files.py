"""The files of classes: patterns become paths with checksums, found from the config's folder on."""

from collections.abc import Callable, Iterator
from glob import has_magic, iglob
from itertools import islice, takewhile
from pathlib import Path

from radhar_cli.config.schema import MAX_FILES, MAX_PATH_LENGTH, Config, FilesConfig
from radhar_cli.errors import ConfigError, FolderError, MotionFileError
from radhar_cli.motion.files.reading import read_motion
from radhar_cli.untrusted import refuse_outside

Refuse = Callable[[str, object, str], ConfigError]


def with_files(config: Config, folder: Path, refuse: Refuse) -> Config:
    """Expand the patterns of a config's classes to files, with the SHA-256 of each.

    A checksum that stands in the config already must be the file's.

    Args:
        config: config whose `classes` may name files.
        folder: folder of the config, from which `motion.folder` is seen.
        refuse: makes an error of (key, value, what would be right).

    Returns:
        The config with every file, and with `motion.folder` as an absolute path.

    Raises:
        ConfigError: as made by `refuse`: a file is missing, is no motion, is another one than the
            checksum says, or there are more than MAX_FILES.
    """
    classes = {slug: one for slug, one in config.classes.items() if isinstance(one, FilesConfig)}
    if not classes:
        return config
    root = (folder / (config.motion.folder or "")).resolve()
    classes_with_files = {
        slug: _find_files(slug, one, root, refuse) for slug, one in classes.items()
    }
    count = sum(len(one.files) for one in classes_with_files.values())
    if count > MAX_FILES:
        raise refuse("classes", f"{count} files", f"should have at most {MAX_FILES} files in all")
    motion = config.motion.model_copy(update={"folder": str(root)})
    return config.model_copy(
        update={"motion": motion, "classes": {**config.classes, **classes_with_files}}
    )


def _find_files(slug: str, one: FilesConfig, root: Path, refuse: Refuse) -> FilesConfig:
    key = f"classes.{slug}.files"
    skeleton = None if one.skeleton is None else root / one.skeleton
    files: dict[str, str] = {}
    for path, known in sorted(_expand_patterns(one, root, key, refuse)):
        try:
            checksum = read_motion(root / path, skeleton).checksum
        except MotionFileError as error:
            raise refuse(key, path, str(error)) from None
        if known not in ("", checksum):
            raise refuse(key, path, f"should have the SHA-256 {known}; the file is another now")
        files[path] = checksum
    if one.file is not None and one.file >= len(files):
        raise refuse(f"classes.{slug}.file", one.file, f"should be below the {len(files)} files")
    return one.model_copy(update={"files": files})


def _expand_patterns(
    one: FilesConfig, root: Path, key: str, refuse: Refuse
) -> Iterator[tuple[str, str]]:
    """Expand the patterns of a class to (path, known checksum or "") of every file."""
    for pattern, known in one.files.items():
        if known or not has_magic(pattern) or (root / pattern).is_file():
            yield pattern, known
            continue
        fixed_part = Path(*takewhile(lambda part: not has_magic(part), Path(pattern).parts))
        paths = sorted(islice(iglob(pattern, root_dir=root), MAX_FILES + 1))  # noqa: PTH207 - also absolute ones
        if not paths:
            raise refuse(key, pattern, f"should name files; there are none like it in {root}")
        if len(paths) > MAX_FILES:
            raise refuse(key, pattern, f"should name at most {MAX_FILES} files")
        for path in paths:
            if len(path) > MAX_PATH_LENGTH:
                raise refuse(key, path, f"should have at most {MAX_PATH_LENGTH} characters")
            refuse_outside(root / path, root / fixed_part)
            yield path, ""


def with_folder(config: Config, folder: Path) -> Config:
    """Point a stored config to the folder in which its motion files lie.

    Raises:
        FolderError: a file of the config would lie outside of the folder.
    """
    root = folder.resolve()
    for slug, one in config.classes.items():
        if not isinstance(one, FilesConfig):
            continue
        for path in (*one.files, *([one.skeleton] if one.skeleton else [])):
            if not (root / path).resolve().is_relative_to(root):
                raise FolderError(
                    f"--motion {folder}: the class {slug!r} names {path}, which lies outside; "
                    "should be a folder that all files of the data set lie in"
                )
    motion = config.motion.model_copy(update={"folder": str(root)})
    return config.model_copy(update={"motion": motion})


def alone(config: Config, slug: str) -> Config:
    """Cut a scene's config down to the motion file that it uses, named by its absolute path.

    Args:
        config: config of a scene, in which files are numbered.
        slug: class of the scene; other classes keep their first file.
    """
    classes = {}
    for name, one in config.classes.items():
        if isinstance(one, FilesConfig):
            number = (one.file or 0) if name == slug else 0
            path, checksum = [*one.files.items()][number]
            whole = str(Path(config.motion.folder or "", path))
            skeleton = one.skeleton and str(Path(config.motion.folder or "", one.skeleton))
            update = {"files": {whole: checksum}, "file": 0, "skeleton": skeleton}
            one = one.model_copy(update=update)
        classes[name] = one
    return config.model_copy(update={"classes": classes})
