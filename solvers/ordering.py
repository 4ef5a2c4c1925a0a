"""Reverse Cuthill-McKee: numbers the unknowns so that the matrix becomes a narrow band.

George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems, ch. 4: breadth first from a vertex of large
eccentricity, neighbours by rising degree, then reversed. (SciPy's is equivalent but loads scipy.sparse, which small scenes avoid.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.intp]


def reverse_cuthill_mckee(rows: Index, cols: Index, size: int) -> Index:
    """The old number of each new unknown [size], for a symmetric pattern given by (rows, cols)."""
    neighbours = _adjacency(rows, cols, size)
    degree = [len(n) for n in neighbours]
    seen = [False] * size
    order: list[int] = []
    for seed in sorted(range(size), key=degree.__getitem__):
        if not seen[seed]:
            order.extend(_breadth_first(_far(seed, neighbours, degree), neighbours, degree, seen))
    return np.array(order[::-1], dtype=np.intp)


def _adjacency(rows: Index, cols: Index, size: int) -> list[list[int]]:
    keys = np.unique(np.concatenate((rows * size + cols, cols * size + rows)))
    keys = keys[keys // max(size, 1) != keys % max(size, 1)]
    ends = np.searchsorted(keys, np.arange(1, size) * size)
    return [part.tolist() for part in np.split(keys % max(size, 1), ends)]


def _far(seed: int, neighbours: list[list[int]], degree: list[int]) -> int:
    """A vertex at the far end of the seed's component: two sweeps towards larger eccentricity."""
    for _ in range(2):
        level, reached = [seed], {seed}
        while True:
            following = []
            for vertex in level:
                for other in neighbours[vertex]:
                    if other not in reached:
                        reached.add(other)
                        following.append(other)
            if not following:
                break
            level = following
        seed = min(level, key=degree.__getitem__)
    return seed


def _breadth_first(seed: int, neighbours: list[list[int]], degree: list[int], seen: list[bool]) -> list[int]:
    order, position = [seed], 0
    seen[seed] = True
    while position < len(order):
        fresh = [other for other in neighbours[order[position]] if not seen[other]]
        fresh.sort(key=degree.__getitem__)
        for other in fresh:
            seen[other] = True
        order.extend(fresh)
        position += 1
    return order


def half_bandwidth(rows: Index, cols: Index, order: Index) -> int:
    place = np.empty(order.size, dtype=np.intp)
    place[order] = np.arange(order.size)
    return int(np.max(np.abs(place[rows] - place[cols]), initial=0))
