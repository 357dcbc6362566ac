"""What is left of a computation that was stopped: its files, and the last result that it handed over.

Guarantee: no temporary file that was reported stays, and the result is saved under a name that replaces no whole one.
"""

import os
from collections.abc import Mapping, Sequence

from ptmcad.process.handover import Topic, identity
from ptmcad.process.streams import report

Reports = Mapping[Topic, Sequence[str]]
"""What the computing process has said last on each topic."""

_CLEAR_LINE = "\r\x1b[K"


def clean_up(reports: Reports, temporaries: Sequence[str]) -> None:
    """Do what the child would have done: clear its line, remove its files."""
    if Topic.PROGRESS in reports:
        report(_CLEAR_LINE)
    for path in filter(os.path.lexists, temporaries):
        try:
            (os.rmdir if os.path.isdir(path) else os.unlink)(path)
        except OSError as error:
            report(f"error: {error}\n")


def what_is_there(placed: Sequence[Sequence[str]]) -> str:
    """Which files a stopped command has written, in words.

    Parameters
    ----------
    placed : for each set of files that was put into place, or was to be, its last file and that file's identity.
    """
    found = [path for path, mark in placed if identity(path) == mark]
    if not found:
        return "nothing was saved"
    if len(found) == 1:
        return f"{found[0]} had been written before and is whole"
    return f"{len(found)} results had been written before and are whole, the last of them {found[-1]}"


def save_last(reports: Reports, why: str) -> int:
    """Save the result that was handed over last, unless the child had come to that itself; return the exit status.

    Parameters
    ----------
    why : it was stopped, as the start of a sentence.
    """
    if Topic.TARGET not in reports:
        report("; ".join(filter(None, (why, *reports.get(Topic.RESUMABLE, ())))) + "\n")
        return 3
    if Topic.RESULT not in reports:
        reason = f": {reports[Topic.RESUMABLE][0]}" if Topic.RESUMABLE in reports else ""
        report(f"{why}; there was no partial map to save yet{reason}\n")
        return 3
    from pathlib import Path  # not before it is needed: every start would pay for it

    from ptmcad.errors import OutputError
    from ptmcad.process.output import how_to_go_on, save_stopped, where_saved

    target, beside = Path(reports[Topic.TARGET][0]), reports[Topic.TARGET][1:]
    state, text, remark = reports[Topic.RESULT]
    placed, mark = reports.get(Topic.RENAMES, ("", ""))
    try:
        if mark and identity(placed) == mark:
            place = Path(placed)
        else:
            place = save_stopped(target, text, whole=state == "complete", beside=beside)
    except OutputError as error:
        report(f"error: {why}, and the {state} map was lost: {error}\n")
        return 2
    further = how_to_go_on(place) if Topic.RESUMABLE in reports and state == "partial" else ""
    where = f"{place}{where_saved(target, place, beside)}{further}"
    report(f"{why}; {state} map{remark} saved to {where}\n")
    return 3
