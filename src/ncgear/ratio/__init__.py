"""The ratio law: from a motion to the driven angle phi2(phi1) over one cycle, with its derivatives."""
