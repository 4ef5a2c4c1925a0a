"""Escalona, Hussien and Shabana (1998), Application of the absolute nodal co-ordinate formulation to multibody system dynamics, J. Sound
Vib. 214, 833-851: its table and figures, in one command.

    python examples/escalona_1998 [folder for the pictures]

Prints every number beside the paper's and a reference's, with what it may differ by, then a table of all formulations on the paper's
scenes, and draws Table 1 and Figs 2, 4, 5, 8, 9 and 10. What the print cannot be right about, and what was chosen instead, is told
before each part.
"""

import sys
from pathlib import Path

import figure_2
import figure_8
import figures_4_5
import figures_9_10
import formulations
import lines
import table_1


def main(folder: str = ".") -> float:
    """Runs all parts; returns the largest share of its limit that a difference takes."""
    place, worst = Path(folder), 0.0
    place.mkdir(parents=True, exist_ok=True)
    for part in (table_1, figure_2, figures_4_5, figure_8, figures_9_10):
        print(f"\n{part.__doc__}\n{lines.HEAD}")
        for line in part.run(place):
            print(line)
            worst = max(worst, line.difference / line.limit)
    print(f"\n{formulations.__doc__}")
    print(formulations.show(formulations.compare()))
    print(f"\nlargest share of an allowed difference: {worst:.2f}; pictures in {place.resolve()}")
    return worst


if __name__ == "__main__":
    main(*sys.argv[1:2])
