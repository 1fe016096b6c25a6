"""To and from the packages that roboticists use beside this one; each is imported only where it is used."""
