"""A position-based solver of your own, in forty lines, that uses selvage for contact alone."""

import numpy as np
import selvage

box = selvage.make("box", size=(0.2, 0.2, 0.2), cell=0.1)
rest = np.vstack([box.V + [0, 0, 0.01], box.V + [0.05, 0.03, 0.24]])  # one box above another, above the ground
mesh = selvage.TetMesh(rest, np.vstack([box.T, box.T + len(box.V)]))
edges, dt = mesh.edges, 1 / 300
length = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
valence = np.bincount(edges.ravel(), minlength=len(rest))[:, None]
volumes = np.linalg.det(rest[mesh.T][:, 1:] - rest[mesh.T][:, :1]) / 6


def keep_lengths(x: np.ndarray) -> None:
    """One Jacobi iteration of stiff springs along the edges."""
    d = x[edges[:, 0]] - x[edges[:, 1]]
    now = np.linalg.norm(d, axis=1)
    move = ((length - now) / (2 * now))[:, None] * d
    change = np.zeros_like(x)
    np.add.at(change, edges[:, 0], move)
    np.add.at(change, edges[:, 1], -move)
    x += 1.5 * change / valence


def keep_apart(x: np.ndarray, contacts: selvage.Contacts) -> None:
    """Projects each contact, one inequality, in turn: along its normal, in proportion to the weights."""
    for n, vertices, w, normal in zip(contacts.vertex_count, contacts.vertices, contacts.weights, contacts.normal):
        vertices, w = vertices[:n], w[:n]
        gap = normal @ (w @ x[vertices])
        if gap < 0:
            x[vertices] -= gap / (w @ w) * np.outer(w, normal)


x, v = rest.copy(), np.zeros_like(rest)
finder = selvage.ContactFinder(mesh)
touched = False
for step in range(240):
    finder.begin_step(x)
    new = x + dt * (v + dt * np.array([0, 0, -9.81]))
    for iteration in range(15):
        keep_lengths(new)
        if iteration == 5:
            contacts = finder.find_contacts(new)  # points inside by their shortest way out, all others by CCD
            touched |= len(contacts) > 0
        if iteration >= 5:
            keep_apart(new, contacts)
        new[:, 2] = np.maximum(new[:, 2], 0)  # the ground
    x, v = new, 0.99 * (new - x) / dt

upper, lower = x[len(box.V) :, 2].min(), x[: len(box.V), 2].max()
print("they touched:", touched)
print("the upper box rests on the lower one:", bool(upper > lower - 0.02), bool(np.abs(v).max() < 0.3))
print("no element is inverted:", bool((np.linalg.det(x[mesh.T][:, 1:] - x[mesh.T][:, :1]) > 0).all()))

# Prints:
# they touched: True
# the upper box rests on the lower one: True True
# no element is inverted: True
