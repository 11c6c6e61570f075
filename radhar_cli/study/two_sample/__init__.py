"""How far two data sets of maps are apart, class by class."""
