"""Families of scenes swept to their extremes until something breaks, and the same sweeps by Exudyn.

    python -m pip install ".[bench]" && python -m benchmarks.stress [--family NAME ...] [--quick]

A ``Family`` (``family.py``) is a quantity, its levels, and a run that returns the error of a result against a reference: a closed form, an
independent integration, an invariance, or the audit where there is nothing else. That a run ended says nothing. The modules of
``FAMILIES`` hold the families; ``peer.py`` runs Exudyn; ``page.py`` writes docs/stress.md.
"""
