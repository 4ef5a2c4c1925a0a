"""Derivations: every kernel from its published formula by sympy, compared with the numbers that it returns.

    law.py, laws.py, beam_laws.py,
    load_laws.py                      an elastic kernel as an energy, a load as a virtual work: forces and tangents by differentiation
    rows.py, masses.py                equations, masses and weights of a scene as expressions
    kernels.py                        the kernels of a scene against these, at random states
    cable.py, chord.py, ...           the steps from a paper's first equation to the kernel
    subjects.py                       all of them by the words of ``python -m mbd derive``; scene_equations.py is ``mbd.equations``

Nothing in the library needs this folder to run; it is the edge of the house, and the only place that imports sympy.
"""
