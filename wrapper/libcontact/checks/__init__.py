"""Warnings of what a scene probably does not intend, before a run and during it."""
