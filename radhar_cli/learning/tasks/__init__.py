"""Tasks of networks, one per file; `choices.TASKS` names them.

task            `Task`: outputs, targets, loss, score, predictions, report
categories      tasks whose outputs are classes by name; `Classifier`: one class an input
classes         activity of the main person; count: number of people
labels          activities of everybody, yes or no for each class
skeleton        the joints of a person in every frame
"""
