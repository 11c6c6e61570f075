"""Networks, one per file. All of them split into `forward_features` and `forward_head`, as timm's.

`forward_head(features, pre_logits=True)` stops before the last layer.
"""
