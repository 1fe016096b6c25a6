"""Conversions to and from other robotics packages; each is imported only when it is used."""
