"""t-SNE of images and of features, and how well either separates the classes."""

import numpy as np
from sklearn.decomposition import PCA
from sklearn.manifold import TSNE
from sklearn.metrics import silhouette_score

from radhar_cli.numerics.arrays import Float, Index, Levels

MAX_POINTS = 2000
FIRST_COMPONENTS = 50
PERPLEXITY = 30.0
SIDE = 64


def select_rows(count: int) -> Index:
    """Numbers of at most 2,000 of `count` rows, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, MAX_POINTS)).astype(int))


def shrink(levels: Levels) -> Float:
    """Vector of an image [H, W, C]: one channel from 0 to 1, averaged down to at most 64 x 64."""
    gray = levels.mean(2)
    down, across = -(-gray.shape[0] // SIDE), -(-gray.shape[1] // SIDE)
    height, width = gray.shape[0] // down * down, gray.shape[1] // across * across
    blocks = gray[:height, :width].reshape(height // down, down, width // across, across)
    vector: Float = blocks.mean((1, 3)).ravel() / 255
    return vector


def embed(vectors: Float) -> Float:
    """Places [N, 2] of vectors [N, F] by t-SNE, after the first 50 principal components."""
    vectors = np.asarray(vectors, dtype=np.float64)
    components = min(FIRST_COMPONENTS, vectors.shape[0], vectors.shape[1])
    if vectors.shape[1] > components:
        vectors = PCA(components, svd_solver="full").fit_transform(vectors)
    perplexity = min(PERPLEXITY, max(1.0, (vectors.shape[0] - 1) / 3))
    tsne = TSNE(2, perplexity=perplexity, init="pca", random_state=0)
    return np.asarray(tsne.fit_transform(vectors))


def separation(vectors: Float, label: Index) -> float | None:
    """Mean silhouette of the classes, -1 to 1; None where a class stands alone."""
    classes = np.unique(label)
    if not 2 <= classes.size < len(label):
        return None
    return float(silhouette_score(np.asarray(vectors, dtype=np.float64), label))
