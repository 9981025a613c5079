"""Kinds of flights, one file each: what a drone is out for decides the path it draws."""
