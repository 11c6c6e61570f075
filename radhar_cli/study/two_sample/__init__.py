"""Distance between two data sets of maps, class by class."""
