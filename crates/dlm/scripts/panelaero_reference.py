#!/usr/bin/env python3
"""Makes tests/data/dlm/panelaero_*.json with PanelAero (DLR, PyPI: panelaero 2025.8, numpy, BSD licence).

Run outside CI, in a virtual environment that has panelaero:
    python3 crates/dlm/scripts/panelaero_reference.py tests/data/dlm
    OPENBLAS_NUM_THREADS=1 python3 crates/dlm/scripts/panelaero_reference.py tests/data/dlm time    (8 GB of memory)
The second writes panelaero_time.csv: CPU time and peak memory of one condition by number of boxes.

What is written for every Mach number, reduced frequency and kernel: the Frobenius norm of the downwash matrix D, its product
with two fixed vectors of signs (a difference of D of relative size e shows there with the same size), and the
pressures dCp of two motions. PanelAero's k is omega/U; ours is omega b/U. PanelAero's own symmetry option is wrong for k > 0,
so a half model is mirrored here and its full matrix is folded: D = D_rr + D_rl.
"""
import json
import sys
import time

import numpy as np
from panelaero import DLM, VLM


def surface(le1, c1, le2, c2, n_chord, n_span):
    """Boxes of a trapezoid, chordwise fastest, as PanelAero's aerogrid wants them."""
    le1, le2 = np.array(le1, float), np.array(le2, float)
    out = {k: [] for k in ("offset_j", "offset_k", "offset_l", "offset_P1", "offset_P3", "N", "A", "l")}
    across = (le2 - le1)[1:]
    span = np.hypot(*across)
    cos, sin = across / span
    for j in range(n_span):
        e1, e2 = j / n_span, (j + 1) / n_span
        em = 0.5 * (e1 + e2)
        at = lambda e: (le1 + e * (le2 - le1), c1 + e * (c2 - c1))
        for i in range(n_chord):
            def point(e, part):
                lead, chord = at(e)
                return lead + np.array([chord * (i + part) / n_chord, 0.0, 0.0])
            chord = at(em)[1] / n_chord
            out["offset_j"].append(point(em, 0.75))
            out["offset_k"].append(point(em, 0.5))
            out["offset_l"].append(point(em, 0.25))
            out["offset_P1"].append(point(e1, 0.25))
            out["offset_P3"].append(point(e2, 0.25))
            out["N"].append([0.0, -sin, cos])
            out["A"].append(chord * span / n_span)
            out["l"].append(chord)
    return {k: np.array(v) for k, v in out.items()}


def join(parts):
    grid = {k: np.concatenate([p[k] for p in parts]) for k in parts[0]}
    grid["n"] = len(grid["A"])
    return grid


def mirror(grid):
    """The port half of a starboard half wing, described from left to right, box by box in the same order."""
    flip = np.array([1.0, -1.0, 1.0])
    other = {k: grid[k] * flip for k in ("offset_j", "offset_k", "offset_l")}
    other["offset_P1"], other["offset_P3"] = grid["offset_P3"] * flip, grid["offset_P1"] * flip
    other["N"] = grid["N"] * flip
    other["A"], other["l"] = grid["A"], grid["l"]
    return other


def downwash(grid, mach, kappa, method):
    import copy
    d, _ = VLM.calc_Ajj(copy.deepcopy(grid), mach)
    d = d.astype(complex)
    if kappa != 0.0:
        d = d + DLM.calc_Ajj(copy.deepcopy(grid), mach, kappa, method)
    return d


def signs(n, seed):
    """Signs from a linear congruential generator (Knuth's MMIX constants), the same as in the test."""
    state, out = seed, []
    for _ in range(n):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        out.append(1.0 if state >> 63 else -1.0)
    return np.array(out)


def pairs(values):
    return [[float(f"{v.real:.12g}"), float(f"{v.imag:.12g}")] for v in values]


def motions(half, kappa):
    """Nose-up pitch about x = 0 and a parabolic bending with twist, along the normal; w = dh/dx + i kappa h."""
    c = half["offset_j"]
    n = half["N"]
    pitch = (-n[:, 2], -c[:, 0] * n[:, 2])
    s2 = c[:, 1] ** 2 + c[:, 2] ** 2
    bend = (0.3 * s2, s2 * (1.0 + 0.3 * c[:, 0]))
    return [slope + 1j * kappa * h for slope, h in (pitch, bend)]


def run(name, note, half, folded, semichord, machs, ks, out):
    grid = join([half, mirror(half)]) if folded else join([half])
    n = len(half["A"])
    cases = []
    for method in ("parabolic", "quartic"):
        for mach in machs:
            for k in ks:
                kappa = k / semichord
                start = time.process_time()
                d = downwash(grid, mach, kappa, method)
                if folded:
                    d = d[:n, :n] + d[:n, n:]
                cases.append({
                    "kernel": method, "mach": mach, "k": k, "norm": float(np.linalg.norm(d)),
                    "d_times_signs": [pairs(d @ signs(n, s)) for s in (1, 2)],
                    "pressures": [pairs(np.linalg.solve(d, w)) for w in motions(half, kappa)],
                })
                print(name, method, mach, k, f"{time.process_time() - start:.2f} s", flush=True)
    text = {"source": "PanelAero 2025.8 (DLR), run by crates/dlm/scripts/panelaero_reference.py", "note": note,
            "semichord": semichord, "boxes": n, "cases": cases}
    with open(f"{out}/panelaero_{name}.json", "w") as f:
        json.dump(text, f, separators=(",", ":"))
        f.write("\n")


def clock(out):
    """One condition, downwash matrix and its inverse, as DLM.calc_Qjj does; one child process per size for its memory."""
    import multiprocessing

    def child(n_chord, n_span, method, queue):
        import resource
        tip = lambda s: [1.0, 3.0 * s, 0.0]
        grid = join([surface(tip(-1), 0.7, [0, 0, 0], 1.0, n_chord, n_span // 2),
                     surface([0, 0, 0], 1.0, tip(1), 0.7, n_chord, n_span // 2)])
        start = time.process_time()
        np.linalg.inv(downwash(grid, 0.8, 1.0, method))
        queue.put((time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024))

    with open(f"{out}/panelaero_time.csv", "w") as f:
        f.write("# PanelAero 2025.8, one thread: D and its inverse at M 0.8, omega/U = 1; CPU seconds, best run; peak memory. "
                "Written by crates/dlm/scripts/panelaero_reference.py\nboxes,kernel,cpu_s,peak_mb\n")
        for n_chord, n_span, repeats in ((20, 20, 3), (40, 40, 2), (50, 80, 1)):
            results = []
            for _ in range(repeats):
                queue = multiprocessing.get_context("fork").Queue()
                process = multiprocessing.get_context("fork").Process(target=child, args=(n_chord, n_span, "parabolic", queue))
                process.start()
                results.append(queue.get())
                process.join()
            f.write(f"{n_chord * n_span},parabolic,{min(r[0] for r in results):.3f},{results[0][1]:.0f}\n")
            f.flush()


def main(out):
    # AGARD 445.6: geometry as in AGARD R-765 (Yates 1987): root chord 0.5587 m, tip chord 0.3682 m, semispan 0.762 m, tip
    # leading edge at x = 0.8094 m.
    agard = surface([0, 0, 0], 0.5587, [0.8094, 0.762, 0], 0.3682, 20, 20)
    run("agard_20x20", "AGARD 445.6 half wing 20 x 20, mirrored (symmetric); k = omega b/U", agard, True, 0.27935,
        [0.0, 0.5, 0.9], [0.0, 0.1, 0.5, 2.0], out)
    ttail = join([
        surface([0.6, -3.0, 0.42], 0.8, [0.0, 0.0, 0.0], 1.4, 5, 8),
        surface([0.0, 0.0, 0.0], 1.4, [0.6, 3.0, 0.42], 0.8, 5, 8),
        surface([3.0, 0.0, 0.0], 1.2, [3.6, 0.0, 1.2], 0.9, 5, 5),
        surface([4.0, -1.2, 1.3], 0.5, [3.6, 0.0, 1.2], 0.9, 4, 5),
        surface([3.6, 0.0, 1.2], 0.9, [4.0, 1.2, 1.3], 0.5, 4, 5),
    ])
    del ttail["n"]
    run("ttail", "wing with dihedral, fin, T-tail with dihedral; both sides given, no symmetry; k = omega b/U", ttail, False, 0.7,
        [0.0, 0.6, 0.9], [0.0, 0.05, 0.5, 2.0], out)


if __name__ == "__main__":
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    if sys.argv[2:] == ["time"]:
        clock(folder)
    else:
        main(folder)
