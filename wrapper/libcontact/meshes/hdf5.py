"""HDF5 files that may be damaged: no other file is opened through them, and nothing is read that their size can't
contain."""

from __future__ import annotations

from typing import Any

from .raw import Reading


def dataset(reading: Reading, group: Any, name: str) -> Any:
    """A dataset of a group that stands in the file itself; None if there is none."""
    import h5py

    link = group.get(name, getlink=True)
    if link is None:
        return None
    if not isinstance(link, h5py.HardLink):
        raise reading.wrong(f"{name} is a link to another place, which is not followed")
    found = group[name]
    if not isinstance(found, h5py.Dataset):
        return None
    if found.external or found.is_virtual:
        raise reading.wrong(f"the numbers of {name} are in another file, which is not opened")
    return found
