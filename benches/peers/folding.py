"""The cloth of folding.toml, for other simulators: its mesh, and a run of 1.5 s with its times."""

import struct
import time

import numpy as np

SIDE = 64  # particles
SPACING = 1 / (SIDE - 1)  # m
THICKNESS = SPACING / 4  # m
MASS = 0.2 / SIDE**2  # kg, of a particle
FRAMES, RATE = 90, 60  # frames, and frames per second
FIRST = 8  # first frame that is timed: the lower edge has met the floor


def mesh():
    """Positions (m, y upwards), a row for each particle, and triangles as three particles each."""
    down = np.array([0, -0.98, 0.2]) / np.hypot(0.98, 0.2)
    row, column = np.divmod(np.arange(SIDE**2), SIDE)
    points = np.array([0, 1.05, 0]) + np.outer(row * SPACING, down)
    points[:, 0] += column * SPACING - 0.5
    a = np.arange(SIDE**2).reshape(SIDE, SIDE)
    a, b, c, d = (part.ravel() for part in (a[:-1, :-1], a[:-1, 1:], a[1:, :-1], a[1:, 1:]))
    return points, np.stack([a, c, b, b, c, d], axis=1).reshape(-1, 3)


def run(path, frame, positions):
    """Writes positions() (m) after each frame() to a PC2 file; prints the processor's times."""
    states, times = [positions().copy()], []
    for _ in range(FRAMES):
        begin = time.process_time()
        frame()
        times.append(1e3 * (time.process_time() - begin))
        states.append(positions().copy())
    with open(path, "wb") as out:
        out.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, SIDE**2, 0, 1, len(states)))
        np.array(states, "<f4").tofile(out)
    later = times[FIRST:]
    print(f"{path}: {np.mean(later):.1f} ms a frame, at most {max(later):.1f} ms")
