"""Loads files with bounded memory, as a process of its own: prints what became of each, and how long it took."""

from __future__ import annotations

import resource
import sys
import time
import warnings
from pathlib import Path


def main(paths: list[str]) -> None:
    import mbd

    mbd.load(paths[0])  # whole: what loading imports is there
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + 256 * 2**20, used + 256 * 2**20))
    warnings.simplefilter("ignore")
    for path in paths:
        clock = time.process_time()
        try:
            mbd.load(path)
            verdict = "loaded"
        except ValueError as error:
            verdict = "refused" if str(error).startswith(path) and len(str(error)) < 2000 else f"at length: {str(error)[:300]!r}"
        except BaseException as error:
            verdict = f"{type(error).__name__}: {error}"[:300].replace("\n", " ")
        print(f"{time.process_time() - clock:.3f} {verdict}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
