#!/usr/bin/env python3
"""MKL Pardiso against our multifrontal solvers on the same matrices, turn by turn.

    python3 -m venv target/pardiso && target/pardiso/bin/pip install pypardiso
    cargo bench --bench linear --no-run            # prints the path of the binary
    target/pardiso/bin/python benches/peers/pardiso.py <binary> [turns] [matrix ...]

Each turn asks for one factorisation and one solve of every solver, number of threads and matrix;
the order of the solvers changes from turn to turn. Printed are medians, and medians of the ratios
within a turn, which the drift of a shared host touches least. One thread is timed by its seconds on a
core, more by the wall clock. Pardiso: phase 22 and phase 33,
all parameters at their defaults (nested dissection by METIS, for mtype 11 scaling and matching);
mtype 2 symmetric positive definite, 1 structurally symmetric, 11 unsymmetric. Ours includes the
copy of the values and, in the solve, the residual. Never a dependency, never run in CI.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pypardiso
import scipy.sparse as sp

THREADS = (1, 2, 4)
PEERS = {"Pardiso SPD": 2, "Pardiso structurally symmetric": 1, "Pardiso unsymmetric": 11}
OURS = {"L Lᵀ": "llt", "L U": "lu"}
AGAINST = {
    "L Lᵀ": ["Pardiso SPD", "Pardiso unsymmetric"],
    "L U": ["Pardiso structurally symmetric", "Pardiso unsymmetric"],
}


def read(path):
    """The matrix; both triangles, so columns are rows but for the transposed values."""
    data = path.read_bytes()
    n, nnz = np.frombuffer(data, "<u8", 2)
    ptr = np.frombuffer(data, "<u8", n + 1, 16)
    rows = np.frombuffer(data, "<u4", nnz, 16 + 8 * (n + 1))
    values = np.frombuffer(data, "<f8", nnz, 16 + 8 * (n + 1) + 4 * nnz)
    return sp.csc_matrix((values, rows.astype(np.int32), ptr.astype(np.int32)), shape=(n, n))


class Pardiso:
    """One matrix, analysed for one matrix type and number of threads."""

    def __init__(self, matrix, mtype, threads):
        self.solver = pypardiso.PyPardisoSolver(mtype=mtype)
        self.a = sp.csr_matrix(sp.triu(matrix, format="csr") if mtype == 2 else matrix.tocsr())
        self.a.sort_indices()
        self.full = matrix
        self.b = np.ones(matrix.shape[0])
        self.threads = threads
        self.call(11)

    def call(self, phase):
        self.solver.libmkl.MKL_Set_Num_Threads(self.threads)
        self.solver.set_phase(phase)
        clock = time.thread_time if self.threads == 1 else time.perf_counter
        start = clock()
        x = self.solver._call_pardiso(self.a, self.b)
        return clock() - start, x

    def turn(self):
        factor, _ = self.call(22)
        solve, x = self.call(33)
        residual = np.abs(self.b - self.full @ x).max()
        assert residual < 1e-6, residual
        return factor, solve


def main():
    binary, turns = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 9
    wanted = sys.argv[3:]
    folder = Path(tempfile.mkdtemp(prefix="wythe-peers-"))
    child = subprocess.Popen(
        [binary, "--peers", str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout.readline().strip() == "ready"

    def ours(name, kind, threads):
        child.stdin.write(f"{name} {kind} {threads}\n")
        child.stdin.flush()
        return [float(word) for word in child.stdout.readline().split()]

    for path in sorted(folder.glob("*.bin"), key=lambda path: path.stat().st_size):
        name = path.stem
        if wanted and name not in wanted:
            continue
        matrix = read(path)
        solvers = {
            (label, threads): Pardiso(matrix, mtype, threads)
            for label, mtype in PEERS.items()
            for threads in THREADS
        }
        keys = list(solvers) + [(label, threads) for label in OURS for threads in THREADS]
        times = {key: [] for key in keys}
        for turn in range(turns + 1):
            for key in keys if turn % 2 else reversed(keys):
                # MKL's threads spin for 0.2 s after their work.
                time.sleep(0.25)
                label, threads = key
                if label in OURS:
                    answer = ours(name, OURS[label], threads)
                    on_core = threads == 1 and answer[5] > 0
                    times[key].append(answer[5:7] if on_core else answer[:2])
                    if turn == 0 and threads == 1:
                        print(f"{name}, {label}: residual {answer[2]:.0e}, "
                              f"{answer[3]:.2e} numbers, {answer[4]:.2e} operations")
                else:
                    times[key].append(solvers[key].turn())
        times = {key: list(zip(*turns[1:])) for key, turns in times.items()}  # the first warms up
        print(f"\n{name}: {matrix.shape[0]} equations, {matrix.nnz} entries; ms, factorise / solve")
        for label in dict.fromkeys(label for label, _ in keys):
            medians = [[1e3 * statistics.median(t) for t in times[label, p]] for p in THREADS]
            print(f"| {label} | " + " | ".join(f"{f:.1f} / {s:.1f}" for f, s in medians) + " |")

        def ratio(a, b, what):
            return statistics.median(x / y for x, y in zip(times[a][what], times[b][what]))

        for label, others in AGAINST.items():
            for other in others:
                ratios = [
                    [ratio((label, p), (other, p), what) for what in (0, 1)] for p in THREADS
                ]
                print(f"| {label} : {other} | "
                      + " | ".join(f"{f:.2f} / {s:.2f}" for f, s in ratios) + " |")
        for label in dict.fromkeys(label for label, _ in keys):
            gain = [ratio((label, 1), (label, p), 0) for p in THREADS[1:]]
            print(f"| {label}, 1 thread : 2, 4 threads | {gain[0]:.2f} | {gain[1]:.2f} |")
        print(flush=True)
    child.stdin.close()
    child.wait()


if __name__ == "__main__":
    main()
