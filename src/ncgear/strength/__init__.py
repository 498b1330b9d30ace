"""Strength of the teeth: materials, loads of every tooth, stresses by two methods, safety and life."""
