#!/usr/bin/python3
"""A velocity limiter based on the gradient of the distance, for the demo robot.

usage: limit_velocity.py [PLOT.png]

The arm is commanded through the post of its table. The limiter keeps the approach speed of each near pair
proportional to its distance from STOP_DISTANCE: d(distance)/dt = gradient . velocity >= -GAIN (distance - STOP_DISTANCE).
"""
import os
import sys

import numpy as np

import collision_pairs as cp

DEMO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../config/demo/demo_robot")
START = np.array([-0.3, 0.75, 0.0, 0.75, 0.0, 0.4, 0.0, 0.02])
GOAL = np.array([1.8, 0.85, 0.0, 0.65, 0.0, 0.4, 0.0, 0.02])
STEP, SECONDS = 0.01, 5.0  # s
SPEED = 0.8  # rad/s
STOP_DISTANCE, WATCHED_DISTANCE = 0.02, 0.2  # m
GAIN = 4.0  # 1/s


def limited(velocity, distances, gradients):
    """The velocity with what is too fast towards each pair taken away, pair by pair, until none is (Kaczmarz)."""
    floor = -GAIN * (distances - STOP_DISTANCE)
    squared = np.einsum("ij,ij->i", gradients, gradients)
    for _ in range(100):
        excess = floor - gradients @ velocity
        worst = np.argmax(np.where(squared > 1e-12, excess, -np.inf)) if len(excess) else None
        if worst is None or excess[worst] < 1e-6 or squared[worst] <= 1e-12:
            break
        velocity = velocity + gradients[worst] * excess[worst] / squared[worst]
    return velocity


def simulate(detector, with_limiter):
    """The smallest distance at each step on the way to GOAL."""
    state, distances = START.copy(), []
    for _ in range(int(SECONDS / STEP)):
        result = detector.check(state, alarm_distance=WATCHED_DISTANCE, min_distance=True, gradient=True)
        distances.append(result.min_distance)
        velocity = np.clip(3.0 * (GOAL - state), -SPEED, SPEED)
        if with_limiter:
            known = ~np.isnan(result.gradient).any(axis=1)  # none for a pair that was not measured
            velocity = limited(velocity, result.pairs["distance"][known], result.gradient[known])
        state = state + STEP * velocity
    return np.array(distances), state


def plot(path, free, held):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    time = np.arange(len(free)) * STEP
    figure, axes = pyplot.subplots(figsize=(7.0, 3.2), dpi=120)
    axes.axhspan(min(free.min(), 0.0) - 0.01, 0.0, color="#d9534f", alpha=0.15)
    axes.axhline(STOP_DISTANCE, color="#888888", linestyle="--", linewidth=1.0)
    axes.annotate("stop distance", (time[-1], STOP_DISTANCE), ha="right", va="bottom", color="#666666")
    axes.plot(time, free, color="#d9534f", label="without limiter")
    axes.plot(time, held, color="#1f77b4", label="with limiter")
    axes.set(xlabel="time / s", ylabel="distance to the post / m", xlim=(0.0, time[-1]))
    axes.set_ylim(bottom=min(free.min(), 0.0) - 0.01)
    axes.legend(frameon=False, loc="center right")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.tight_layout()
    figure.savefig(path)


def main():
    robot = cp.Robot(DEMO + ".urdf", srdf=DEMO + ".srdf")
    detector = cp.Detector(cp.Scene(robot, settings={"links": ["post"]}))  # only pairs with the post
    (free, _), (held, end) = simulate(detector, False), simulate(detector, True)
    print("smallest distance without limiter %.1f mm, with limiter %.1f mm; shoulder_pan stopped at %.2f rad" %
          (1000 * free.min(), 1000 * held.min(), end[0]))
    if len(sys.argv) > 1:
        plot(sys.argv[1], free, held)


if __name__ == "__main__":
    main()
