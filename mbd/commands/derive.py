"""Derives the equations behind the numbers, step by step with their sources, and compares them with what the kernels return."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

HELP = "equations of elements and joints, step by step; --check compares every kernel with them"


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("subject", nargs="*", help="ancf_cable, local_frame, rigid_body, pin, ...; all without one")
    parser.add_argument("--latex", metavar="FILE", type=Path, help="write the steps as a LaTeX document")
    parser.add_argument("--check", action="store_true", help="compare with the kernels; exit code 1 if a difference is above rounding")
    parser.add_argument("--list", action="store_true", help="list the subjects")


def run(options: argparse.Namespace) -> int:
    from mbd.derivations import subjects

    words = subjects.words()
    unknown = [word for word in options.subject if word not in words]
    if unknown:
        options.parser.error(f"expected subjects among {', '.join(words)}; found {', '.join(unknown)}")
    if options.list:
        print("\n".join(words))
        return 0
    wanted = options.subject or words
    if options.check:
        return check(wanted)
    found = [(word, subjects.steps(word)) for word in wanted]
    if options.latex:
        options.latex.write_text(document(found), encoding="utf-8")
        return 0
    for word, steps in found:
        print(f"{word}\n{'=' * len(word)}\n")
        for k, step in enumerate(steps, 1):
            print(f"{k}. {step}\n")
    return 0


def check(words: Iterable[str]) -> int:
    """Prints a table of all comparisons; 1 if one of them fails."""
    from mbd.derivations import subjects

    clock, count, wrong = time.perf_counter(), 0, []
    print(f"{'subject':<16} {'worst':>8}  {'kernel':<48} quantity: step")
    for word in words:
        for step in subjects.steps(word):
            worst = step.worst()
            count += 1
            line = f"{word:<16} {worst.difference:8.1e}  {step.kernel:<48} {worst.quantity}: {step.title}"
            print(line if worst.exact else f"{line}   <-- WRONG", flush=True)
            if not worst.exact:
                wrong.append(f"{step.kernel}: {worst.quantity} ({word}: {step.title}) differs by {worst.difference:.1e} from {step.source}")
    print(f"\n{count} comparisons in {time.perf_counter() - clock:.0f} s, {len(wrong)} wrong")
    for line in wrong:
        print(f"wrong: {line}", file=sys.stderr)
    return 1 if wrong else 0


def document(found: Iterable[tuple[str, list[Any]]]) -> str:
    """A LaTeX document: a section for each subject, an equation for each step, shrunk to the line where it is longer."""
    lines = [
        r"\documentclass{article}",
        r"\usepackage{amsmath, graphicx}",
        r"\newcommand{\fit}[1]{\noindent\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{$\displaystyle #1$}}",
        r"\begin{document}",
    ]
    for word, steps in found:
        lines.append(rf"\section*{{{_plain(word)}}}")
        for step in steps:
            lines += [rf"\paragraph{{{_plain(step.title)}}} ({_plain(step.source)})\par", *(rf"\fit{{{line}}}\par" for line in step.latex)]
    return "\n".join([*lines, r"\end{document}", ""])


def _plain(text: str) -> str:
    """Words for LaTeX."""
    for sign, safe in (("\\", r"\textbackslash "), ("_", r"\_"), ("^", r"\^{}"), ("|", r"$|$"), ("'", "'"), ("&", r"\&"), ("{", r"\{"), ("}", r"\}")):
        text = text.replace(sign, safe)
    return text
