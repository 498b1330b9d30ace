"""Parts around the gears: bearings, shafts and keys, losses, motor, flywheel and the couplings before them."""
