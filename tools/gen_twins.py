"""Render the scenes of ``tests/paths/twins.py`` with Mitsuba 3, and store the light of tiles.

Needs Mitsuba (``pip install -e '.[twins]'``); its variant llvm_ad_rgb also LLVM's shared library
(DRJIT_LIBLLVM_PATH). The tests need neither.

    python tools/gen_twins.py [--only WORD] [--spp 512] [--runs 32] [--variant llvm_ad_rgb]
"""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.paths.twins import TWINS, Twin, mean_and_error, tiles  # noqa: E402

DATA = ROOT / "tests" / "paths" / "data" / "twins.npz"


def rendered(mi: Any, twin: Twin, spp: int, runs: int) -> tuple[Any, Any]:
    """Return the mean light of each tile and its standard error, from independent pictures."""
    scene = mi.load_dict(twin.theirs(mi))
    pictures = [np.array(mi.render(scene, spp=spp, seed=seed)) for seed in range(runs)]
    return mean_and_error(tiles(np.stack(pictures)))


def main() -> None:
    """Render and store."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="a word of the names of the scenes to render")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--runs", type=int, default=32)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    asked = parser.parse_args()
    mi = importlib.import_module("mitsuba")
    mi.set_variant(asked.variant)
    stored = dict(np.load(DATA)) if DATA.exists() else {}
    kept = {f"{name}: {what}" for name in TWINS for what in ("mean", "error")}
    stored = {key: value for key, value in stored.items() if key in kept}
    for name, twin in TWINS.items():
        if asked.only in name:
            mean, error = rendered(mi, twin, asked.spp, asked.runs)
            stored[f"{name}: mean"] = mean.astype(np.float32)
            stored[f"{name}: error"] = error.astype(np.float32)
            share = float(np.median(error / np.maximum(mean, 1e-6)))
            print(f"{name:40} light {mean.mean():.4f}, error of a tile {share:.2%}", flush=True)
    np.savez_compressed(DATA, **stored)


if __name__ == "__main__":
    main()
