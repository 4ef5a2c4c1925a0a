"""Run time against error: mbd and Exudyn on the same scenes, in turn, in one process. ``python -m benchmarks --help``.

machines.py                      the numbers that both programs' scenes are made of
scenes.py, exudyn_scenes.py      the scenes in mbd, and the same in Exudyn
mbd_runs.py, exudyn_runs.py      each program's methods, settings and timing
work.py                          sweeps of runs, in turn, with medians
fronts.py, checks.py             the best of a program at every error; whether both solve one problem
tables.py, report.py, plots.py   what is printed and written to docs/benchmarks
fits.py                          powers of size, excess of looser runs, marks of what exceeds a bar
scaling.py, probes.py            what size costs in time and memory: ``python -m benchmarks.scaling``
accuracy.py                      what the default does with a tolerance: ``python -m benchmarks.accuracy``
references.py                    makes data/references.json anew
"""

import os
import sys

sys.exudynFast = True  # type: ignore[attr-defined]  # read by Exudyn's __init__: the module without range checks
# Before NumPy is loaded: one thread for both programs.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
