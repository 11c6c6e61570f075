"""What a network learns, one task per file; `choices.TASKS` names them.

task            `Task`: outputs, targets, loss, score, predictions, report
categories      tasks whose outputs are classes by name; `Classifier`: one class an input
classes         what the main person does; count: how many people there are
labels          what anybody does, yes or no for each class
skeleton        the joints of a person in every frame
"""
