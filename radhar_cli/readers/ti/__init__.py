"""Files of TI: the .cfg of a board, and the headers of captures with mmWave Studio."""
