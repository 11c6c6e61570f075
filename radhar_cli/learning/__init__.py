"""Train and evaluate classifiers of maps.

The only package that imports PyTorch; the extra `train` installs it.

    settings        the YAML file of `radhar train`; registry: the networks and tasks it may name
    images/         labelled images or sequences of dataset.h5, or of class folders
    batches         which images make a step; augmentation
    tasks/          tasks to learn, one per file: targets, loss, score, report
    models/         one network per file; timm_networks: those of timm
    machine         device, precision, reading processes, repeatable runs
    optimiser       learning rate, update
    learner         a training step, validation; training_set: what is learned from
    training        epochs, the best one, resuming; starting_point: --init
    run_folder      the files of a run, and how they are read safely; run_summary
    evaluation      probabilities, features and speed; metrics: how good they are
    report          `radhar eval`: evaluated_run and the reports of tasks/ fill it
    adaptation      batch norm fitted to unlabelled images
    torch_dataset   samples and sequences for a PyTorch DataLoader
    onnx_export     the network without PyTorch
"""
