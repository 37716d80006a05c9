"""Writes the ward's models and directives from its map: run it after changing the map or the furnishing."""

from __future__ import annotations

from mala_drake.resources import models_folder
from mala_drake.ward.models import PACKAGE_FOLDER, ward_directives, ward_files
from mala_drake.ward.ward_map import LoadWard


def main() -> None:
    ward = LoadWard()
    folder = models_folder() / PACKAGE_FOLDER
    folder.mkdir(exist_ok=True)
    files = ward_files(ward)
    for stale in sorted({path.name for path in folder.iterdir()} - set(files)):
        (folder / stale).unlink()
    for name, write in files.items():
        (folder / name).write_text(write(), encoding="utf-8")
    (models_folder() / f"{ward.name}.dmd.yaml").write_text(ward_directives(ward), encoding="utf-8")
    print(f"{len(files)} files in {folder}")


if __name__ == "__main__":
    main()
