"""The seed of random tests: COLLISION_PAIRS_SEED, or the same in every run. It is printed, as by random_inputs.h."""
import os


def given_seed():
    seed = int(os.environ.get("COLLISION_PAIRS_SEED", "20240611")) % 2**32
    print("seed %d (COLLISION_PAIRS_SEED=%d repeats this run)" % (seed, seed))
    return seed
