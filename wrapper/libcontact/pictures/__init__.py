"""Pictures and films of runs and of projections; the extra ``plot`` installs matplotlib for them."""
