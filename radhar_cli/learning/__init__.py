"""Train and evaluate classifiers of maps.

The only package that imports PyTorch; `pip install 'radhar[train]'` installs it.

    settings        the YAML file of `radhar train`
    images/         labelled images or sequences of dataset.h5, or of class folders
    batches         which images make a step; augmentation
    models/         one network per file; zoo: those of timm
    machine         device, precision, reading processes, what is repeatable
    optimiser       learning rate, update; targets: losses of what is learned
    training        epochs, validation, the best one, resuming; starting_point: --init
    run_folder      the files of a run, and how they are read safely; run_summary
    evaluation      probabilities, features and speed; metrics: how good they are
    report          `radhar eval`: single_result, labels_result, skeleton_result fill it
    adaptation      batch norm fitted to unlabelled images
    stream          samples for a PyTorch DataLoader, synthesised in its workers; sequences: stored
    onnx_export     the network without PyTorch
"""
