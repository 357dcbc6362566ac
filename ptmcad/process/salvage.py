"""What is left of a computation that was stopped: its files, and the last result that it handed over.

Guarantee: no temporary file that was reported stays, a set of files that was begun to be put into place is completed,
and the result is saved under a name that replaces no whole one.
"""

import os
from collections.abc import Mapping, Sequence

from ptmcad.process.handover import Topic
from ptmcad.process.streams import report

Reports = Mapping[Topic, Sequence[str]]
"""What the computing process has said last on each topic."""

_CLEAR_LINE = "\r\x1b[K"


def clean_up(reports: Reports, temporaries: Sequence[str], seconds: float) -> None:
    """Do what the child would have done: clear its line, put into place what it has begun to, remove its files.

    Parameters
    ----------
    seconds : to wait for another process that writes in the same folder.
    """
    if Topic.PROGRESS in reports:
        report(_CLEAR_LINE)
    journal = reports.get(Topic.RENAMES, [""])[0]
    temporaries = [path for path in temporaries if os.path.lexists(path)]
    if not journal and not temporaries:
        return
    from pathlib import Path  # not before it is needed: every start would pay for it

    from ptmcad.errors import OutputError
    from ptmcad.process.commit import discard, finish

    try:
        if journal:
            finish(Path(journal), seconds)
        discard(map(Path, temporaries))
    except (OSError, OutputError) as error:
        report(f"error: {error}\n")


def what_is_there(placed: Sequence[tuple[str, str]]) -> str:
    """Which files a stopped command has written, in words.

    Parameters
    ----------
    placed : for each set of files that was put into place, or was to be, its last file and that file's identity.
    """
    if not placed:
        return "nothing was saved"
    from pathlib import Path  # not before it is needed: every start would pay for it

    from ptmcad.process.commit import identity

    found = [path for path, mark in placed if identity(Path(path)) == mark]
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
    from ptmcad.process.commit import identity
    from ptmcad.process.output import how_to_go_on, save_stopped, where_saved

    target, beside = Path(reports[Topic.TARGET][0]), reports[Topic.TARGET][1:]
    state, text, remark = reports[Topic.RESULT]
    _, placed, mark = reports.get(Topic.RENAMES, ("", "", ""))
    try:
        if mark and identity(Path(placed)) == mark:
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
