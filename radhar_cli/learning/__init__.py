"""Train and evaluate classifiers of maps.

The only room with PyTorch in it; `pip install radhar[train]` brings what it needs.

    settings      the YAML file of `radhar train`
    images        labelled images: of dataset.h5, or of anyone's tree of class folders
    batches       which images make a step, the same for any number of processes
    models        one network per file; the zoo
    machine       device, precision, threads, memory
    training      epochs, validation, the best epoch, going on after a kill
    run_folder    what a run leaves on disk, and how it is read safely
    evaluation    probabilities and features of a set of images; metrics says how good they are
    report        the figures and tables of `radhar eval`
"""
