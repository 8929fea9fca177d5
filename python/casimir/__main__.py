"""The program: ``python -m casimir``, and the command ``casimir``."""

import os
import shutil
import signal
import sys
from pathlib import Path

from . import _core


def main() -> None:
    """Runs the program with the arguments of the command line."""
    # The program handles its signals itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    beside = Path(sys.executable).with_name("casimir" + ".exe" * (os.name == "nt"))
    program = beside if beside.exists() else Path(shutil.which("casimir") or sys.argv[0])
    sys.exit(_core.main(str(program.absolute()), ["casimir", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
