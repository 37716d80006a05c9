"""A fingerprint of the code and data that results come from, to tell whether two results can be of one experiment."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from mala_drake.errors import BadInput
from mala_drake.resources import domains_folder, models_folder

_DIGITS = 16  # Hexadecimal, of the SHA-256: enough to tell versions of one package apart.


def fingerprint(ward: str = "") -> str:
    """That of this package: 16 hexadecimal digits, the same in a checkout and in the wheel that is built from it.

    Args:
        ward: path of a ward map of the user's own, which then counts too; empty if there is none.

    Raises:
        BadInput: when that file cannot be read.
    """
    if not ward:
        return _of_this_package()
    try:
        content = Path(ward).read_bytes()
    except OSError as error:
        raise BadInput(ward, f"cannot be read ({error.strerror})", "a readable ward map") from None
    return _short(hashlib.sha256(f"{_of_this_package()}\0{_digest(content)}\n".encode()))


def fingerprint_of(package: Path, models: Path, domains: Path) -> str:
    """The fingerprint of the Python modules in a package and of all files in the folders of its data.

    Names below the folders and contents count; where the folders are, in which order a file system lists them, and how
    lines end does not.

    Args:
        package: folder of the modules; in a wheel the other two are in it.
        models: folder of the models.
        domains: folder of the PDDL files.
    """
    found = [(f"package/{name}", path) for name, path in _files(package) if path.suffix == ".py"]
    for folder, title in ((models, "models"), (domains, "domains")):
        found += [(f"{title}/{name}", path) for name, path in _files(folder)]
    total = hashlib.sha256()
    for name, path in sorted(found):
        total.update(f"{name}\0{_digest(path.read_bytes())}\n".encode())
    return _short(total)


@cache
def _of_this_package() -> str:
    return fingerprint_of(Path(__file__).resolve().parent, models_folder(), domains_folder())


def _digest(content: bytes) -> str:
    """That of a file's content, however its lines end."""
    return hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()


def _short(total: hashlib._Hash) -> str:
    return total.hexdigest()[:_DIGITS]


def _files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Every file with its name below the folder, but hidden ones and Python's own."""
    for path in folder.rglob("*"):
        parts = path.relative_to(folder).parts
        if path.is_file() and not any(part.startswith(".") or part == "__pycache__" for part in parts):
            yield "/".join(parts), path
