"""Files of classes: patterns become paths with checksums, looked up from the config's folder on."""

from collections.abc import Callable, Iterator
from glob import has_magic, iglob
from itertools import islice, takewhile
from pathlib import Path

from radhar_cli.config.classes import MAX_FILES, MAX_PATH_LENGTH, FilesConfig
from radhar_cli.config.data_set import Config
from radhar_cli.errors import ConfigError, FolderError, MotionFileError
from radhar_cli.files.untrusted import refuse_outside

Refuse = Callable[[str, object, str], ConfigError]


def resolve_files(config: Config, folder: Path, refuse: Refuse) -> Config:
    """Look up every file that classes name, and write its SHA-256 beside it.

    Args:
        config: Config whose `classes` may name files by patterns.
        folder: Folder of the config, from which `motion.folder` goes on.
        refuse: Makes an error of (key, value, what would be right).

    Returns:
        A config with paths for patterns and an absolute `motion.folder`; the same one without
        files.

    Raises:
        ConfigError: As made by `refuse`: a file is missing, is no motion, is another one than its
            checksum says, or there are more than MAX_FILES.
    """
    classes = {
        slug: files_config
        for slug, files_config in config.classes.items()
        if isinstance(files_config, FilesConfig)
    }
    if not classes:
        return config
    root = (folder / (config.motion.folder or "")).resolve()
    resolved = {
        slug: _resolve_class(slug, files_config, root, refuse)
        for slug, files_config in classes.items()
    }
    count = sum(len(files_config.files) for files_config in resolved.values())
    if count > MAX_FILES:
        raise refuse("classes", f"{count} files", f"should have at most {MAX_FILES} files in all")
    motion = config.motion.model_copy(update={"folder": str(root)})
    return config.model_copy(update={"motion": motion, "classes": {**config.classes, **resolved}})


def _resolve_class(slug: str, files_config: FilesConfig, root: Path, refuse: Refuse) -> FilesConfig:
    """Class of files with every path and its SHA-256."""
    from radhar_cli.readers.motion.reading import read_motion  # slow to import

    key = f"classes.{slug}.files"
    skeleton = None if files_config.skeleton is None else root / files_config.skeleton
    files: dict[str, str] = {}
    for path, expected in sorted(_expand_patterns(files_config, root, key, refuse)):
        try:
            checksum = read_motion(root / path, skeleton).checksum
        except MotionFileError as error:
            raise refuse(key, path, str(error)) from None
        if expected not in ("", checksum):
            raise refuse(key, path, f"should have the SHA-256 {expected}; the file is another now")
        files[path] = checksum
    if files_config.file is not None and files_config.file >= len(files):
        raise refuse(
            f"classes.{slug}.file", files_config.file, f"should be below the {len(files)} files"
        )
    return files_config.model_copy(update={"files": files})


def _expand_patterns(
    files_config: FilesConfig, root: Path, key: str, refuse: Refuse
) -> Iterator[tuple[str, str]]:
    """(path, checksum or "") of every file that a class names."""
    for pattern, checksum in files_config.files.items():
        if checksum or not has_magic(pattern) or (root / pattern).is_file():
            yield pattern, checksum
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


def set_motion_folder(config: Config, folder: Path) -> Config:
    """Look for the files of a stored config in a folder, and nowhere else.

    Raises:
        FolderError: A class names a file that lies outside.
    """
    root = folder.resolve()
    for slug, files_config in config.classes.items():
        if not isinstance(files_config, FilesConfig):
            continue
        for path in (
            *files_config.files,
            *([files_config.skeleton] if files_config.skeleton else []),
        ):
            if not (root / path).resolve().is_relative_to(root):
                raise FolderError(
                    f"--motion {folder}: the class {slug!r} names {path}, which lies outside; "
                    "should be a folder that all files of the data set lie in"
                )
    motion = config.motion.model_copy(update={"folder": str(root)})
    return config.model_copy(update={"motion": motion})


def keep_used_files(config: Config, slug: str) -> Config:
    """Reduce a scene's config to the files that it needs: one of each class, by its full path.

    Args:
        slug: Class of the scene, whose chosen file is kept; of the others the first.
    """
    classes = {}
    for name, files_config in config.classes.items():
        if isinstance(files_config, FilesConfig):
            number = (files_config.file or 0) if name == slug else 0
            path, checksum = [*files_config.files.items()][number]
            full_path = str(Path(config.motion.folder or "", path)) + "/" * path.endswith("/")
            skeleton = files_config.skeleton and str(
                Path(config.motion.folder or "", files_config.skeleton)
            )
            update = {"files": {full_path: checksum}, "file": 0, "skeleton": skeleton}
            files_config = files_config.model_copy(update=update)
        classes[name] = files_config
    return config.model_copy(update={"classes": classes})
