"""Write files: completely or not at all, and never over what another program saved unseen.

Input: a path and bytes, and what the caller knows of the file that they replace. Output: the file,
replaced in one step, with the mode and the owner of the old one; or lines that are added to one as
they come (``appending``), for tables that a killed process must not lose. Every file that distal
writes for its user is written here. Needs the standard library alone.
"""

from distal.file_writer.appending import LineAppender, appending, only_writer
from distal.file_writer.destinations import (
    ChangedError,
    LinkedError,
    SaveError,
    TakenError,
    check_destination,
    check_ours,
    name_beside,
)
from distal.file_writer.private_files import write_private
from distal.file_writer.writing import (
    ANY,
    SavedBytes,
    Unchecked,
    digest_of,
    move_into_place,
    replacement,
    save,
)

__all__ = [
    "ANY",
    "ChangedError",
    "LineAppender",
    "LinkedError",
    "SaveError",
    "SavedBytes",
    "TakenError",
    "Unchecked",
    "appending",
    "check_destination",
    "check_ours",
    "digest_of",
    "move_into_place",
    "name_beside",
    "only_writer",
    "replacement",
    "save",
    "write_private",
]
