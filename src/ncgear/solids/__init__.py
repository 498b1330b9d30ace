"""Gear bodies: tooth outline, bore, keyway and index hole, extruded to a solid that is checked before it is used."""
