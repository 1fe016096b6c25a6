"""Stands here so that every test below finds the modules of this folder."""
