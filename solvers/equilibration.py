"""Scales for KKT matrices of very unequal masses or stiffnesses.

In units in which every mass is 1, a light body that joints hold to heavy ones has equations that look dependent: the heavy hardly move for it.
What a coordinate has to be scaled by is not its own mass but what moves with it. The scales d of a matching of rows and columns whose entries
have the largest product make these entries 1, d_i |a_ij| d_j, and all others 1 at most: masses are matched where they decide the motion, equations
elsewhere. Duff and Koster (2001), SIAM J. Matrix Anal. Appl. 22, 973-996; symmetric matrices: Duff and Pralet (2005), ibid. 27, 313-340.
"""

from __future__ import annotations

import numpy as np

from .system import Array, Index

GRAIN = 2.0**-10
"""Logarithms are whole multiples of this: their sums are exact, without which the search for a matching may go round in circles."""


def moved_with(diagonal: Array, rows: Index, cols: Index, slopes: Array, m: int) -> Array | None:
    """[n]: scales of coordinates by the inertia that moves with them, from M's diagonal [n] and the magnitudes of entries of G [m, n], of which
    those in one place are summed; None where coordinates have neither inertia nor equations enough."""
    n = diagonal.size
    own = np.arange(n)
    keys, slot = np.unique(rows * n + cols, return_inverse=True)
    top, left, sizes = keys // n + n, keys % n, np.bincount(slot, slopes, minlength=keys.size)
    entries = np.concatenate((diagonal, sizes, sizes)).astype(float)
    found = equilibrated(np.concatenate((own, top, left)), np.concatenate((own, left, top)), entries, n + m)
    return None if found is None else found[:n]


def alike(rows: Index, cols: Index, sizes: Array, together: Index) -> Array | None:
    """[size]: scales that make the entries of a matrix alike, the same for unknowns of the same number in ``together`` [size]: what a beam
    resists along and across itself stays apart wherever it points."""
    found = equilibrated(rows, cols, sizes, together.size)
    if found is None:
        return None
    smallest = np.full(together.size, np.inf)
    np.minimum.at(smallest, together, found)
    return smallest[together]


def equilibrated(rows: Index, cols: Index, sizes: Array, count: int) -> Array | None:
    """d [count] for a symmetric matrix with entries of these sizes, both halves given, each once; None where no such matching exists."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    if not np.isfinite(sizes).all():
        return None
    kept = sizes > 0.0
    rows, cols, cost = rows[kept], cols[kept], -GRAIN * np.round(np.log(sizes[kept]) / GRAIN)
    shift = 1.0 - cost.min(initial=0.0)  # weights have to be positive to be told from missing entries
    graph = coo_array((cost + shift, (rows, cols)), shape=(count, count)).tocsr()
    try:
        of_row, partner = min_weight_full_bipartite_matching(graph)
    except ValueError:
        return None
    matched = np.empty(count, dtype=np.intp)
    matched[of_row] = partner
    own = np.empty(count)
    chosen = matched[rows] == cols
    own[rows[chosen]] = cost[chosen]
    right = _potentials(matched[rows], cols, cost - own[rows], count)
    left = own - right[matched]
    return np.exp(0.5 * (left + right))


def _potentials(tails: Index, heads: Index, lengths: Array, count: int) -> Array:
    """Numbers p [count] with p[head] <= p[tail] + length for all edges: Bellman and Ford's shortest paths."""
    found = np.zeros(count)
    for _ in range(count):
        before = found.copy()
        np.minimum.at(found, heads, before[tails] + lengths)
        if np.array_equal(before, found):
            break
    return found
