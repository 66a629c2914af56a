"""The folder of real CAD files that acceptance commands run on, where there is one."""
import argparse
import os
import pathlib

SKIPPED = 77  # what ctest takes as "skipped"


def options_of(description, program, seconds, out=None):
    """Command line: PROGRAM [FOLDER] [--seconds S] [--out OUT]; `folder` is None without one."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument(program)
    parser.add_argument("folder", nargs="?", default=os.environ.get("ISOCHOR_EXTRA_DATA"))
    parser.add_argument("--seconds", type=type(seconds), default=seconds)
    if out is not None:
        parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(out))
    options = parser.parse_args()
    if not options.folder or not pathlib.Path(options.folder).is_dir():
        print("skipped: no folder of real files (set ISOCHOR_EXTRA_DATA)")
        options.folder = None
    elif out is not None:
        options.out.mkdir(parents=True, exist_ok=True)
    return options


def files_of(folder, suffixes):
    """The CAD files below a folder, in order."""
    return sorted(p for p in pathlib.Path(folder).rglob("*") if p.suffix.lower() in suffixes)


def note_run(path):
    """Counts a file as run, for `./test`."""
    log = os.environ.get("ISOCHOR_EXTRA_DATA_LOG")
    if log:
        with open(log, "a", encoding="utf-8") as lines:
            lines.write(f"{path.name}\n")
