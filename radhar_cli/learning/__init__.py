"""Train and evaluate classifiers of maps.

The only room with PyTorch in it; `pip install 'radhar[train]'` brings what it needs.

    settings        the YAML file of `radhar train`
    images/         labelled images of dataset.h5, or of anyone's tree of class folders
    batches         which images make a step, the same for any number of processes
    models/         one network per file; the zoo
    machine         device, precision, memory; work: in what portions a run goes through it
    processes       several of them training one network
    gradient_step   logits, loss, gradient, update; schedule: the learning rate
    training        epochs, validation, the best one, going on after a kill
    run_folder      what a run leaves on disk, and how it is read safely; run_summary
    evaluation      probabilities, features and speed; metrics: how good they are
    report          `radhar eval`: single_result and comparison fill it, report_files writes it
    prediction      classes of single images; onnx_export
"""
