"""Whether the teeth hold: materials, loads of every tooth, stresses by two methods, safety and life."""
