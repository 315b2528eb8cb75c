"""Alternating paths that join the triangles still free.

First trees grown from all free triangles at once, without blossoms, which finds nearly all of them; then the search
of Edmonds (1965), "Paths, trees, and flowers", DOI 10.4153/CJM-1965-045-4, breadth first from one free triangle at a
time. Only what that search touches is reset afterwards.
"""

from __future__ import annotations

from numba import njit

BASE, PARENT, OUTER, MARK, WORK_COLUMNS = 0, 1, 2, 3, 4


@njit(nogil=True, cache=True, _nrt=False)
def _touch(t, work, touched, n):
    """Enter a triangle into the search unless it is in it."""
    if work[t, BASE] < 0:
        work[t, BASE] = t
        touched[n] = t
        return n + 1
    return n


@njit(nogil=True, cache=True, _nrt=False)
def _common_base(a, b, mate, work, mark):
    """Return where the alternating paths from two outer triangles to the root meet."""
    while True:
        a = work[a, BASE]
        work[a, MARK] = mark
        if mate[a] < 0:
            break
        a = work[mate[a], PARENT]
    while True:
        b = work[b, BASE]
        if work[b, MARK] == mark:
            return b
        b = work[mate[b], PARENT]


@njit(nogil=True, cache=True, _nrt=False)
def _flag_path(v, base, child, mate, work, flag):
    """Flag the bases on the path from v down to the blossom's base, and let its triangles be reached both ways."""
    while work[v, BASE] != base:
        work[work[v, BASE], MARK] = flag
        work[work[mate[v], BASE], MARK] = flag
        work[v, PARENT] = child
        child = mate[v]
        v = work[mate[v], PARENT]


@njit(nogil=True, cache=True, _nrt=False)
def _contract(t, u, mate, work, touched, n_touched, queue, tail, mark):
    """Shrink the blossom that the edge from t to u closes; its inner triangles become outer ones."""
    base = _common_base(t, u, mate, work, mark)
    flag = mark + 1
    _flag_path(t, base, u, mate, work, flag)
    _flag_path(u, base, t, mate, work, flag)
    for k in range(n_touched):
        v = touched[k]
        if work[work[v, BASE], MARK] == flag:
            work[v, BASE] = base
            if work[v, OUTER] == 0:
                work[v, OUTER] = 1
                queue[tail] = v
                tail += 1
    return tail


@njit(nogil=True, cache=True, _nrt=False)
def _search(root, most, twin, mate, work, touched, queue):
    """Return a free triangle that an alternating path joins to the root, or -1, and how many were touched."""
    n_touched = _touch(root, work, touched, 0)
    work[root, OUTER] = 1
    queue[0] = root
    head, tail, mark = 0, 1, 1
    while head < tail and n_touched < most:
        t = queue[head]
        head += 1
        for e in range(3 * t, 3 * t + 3):
            if twin[e] < 0:
                continue
            u = twin[e] // 3
            if mate[t] == u or (work[u, BASE] >= 0 and work[u, BASE] == work[t, BASE]):
                continue
            if u == root or (mate[u] >= 0 and work[mate[u], PARENT] >= 0):
                tail = _contract(t, u, mate, work, touched, n_touched, queue, tail, mark)
                mark += 2
            elif work[u, PARENT] < 0:
                n_touched = _touch(u, work, touched, n_touched)
                work[u, PARENT] = t
                if mate[u] < 0:
                    return u, n_touched
                n_touched = _touch(mate[u], work, touched, n_touched)
                work[mate[u], OUTER] = 1
                queue[tail] = mate[u]
                tail += 1
    return -1, n_touched


@njit(nogil=True, cache=True, _nrt=False)
def augment(start, stop, free, most, twin, mate, work, touched, queue):
    """Join free triangles ``free[start:stop]`` along alternating paths of at most ``most`` touched triangles.

    ``work`` is (T, 4) int32, its first two columns -1 and the others 0 before and after.
    """
    for k in range(start, stop):
        root = free[k]
        if mate[root] >= 0:
            continue
        u, n_touched = _search(root, most, twin, mate, work, touched, queue)
        while u >= 0:
            t = work[u, PARENT]
            onward = mate[t]
            mate[u], mate[t] = t, u
            u = onward
        for i in range(n_touched):
            work[touched[i], BASE] = work[touched[i], PARENT] = -1
            work[touched[i], OUTER] = work[touched[i], MARK] = 0


@njit(nogil=True, cache=True, _nrt=False)
def _flip_up(t, mate, parent):
    """Exchange joined and open edges on the path from an outer triangle up to its root, which leaves t free."""
    above = mate[t]
    while above >= 0:
        p = parent[above]
        onward = mate[p]
        mate[above], mate[p] = p, above
        above = onward


@njit(nogil=True, cache=True, _nrt=False)
def forest(twin, mate, root, parent, dead, queue):
    """Grow alternating trees from all free triangles and join those whose trees meet; return how many pairs.

    ``root`` is the free triangle whose tree one belongs to, plus one for the outer ones, negative for the inner.
    """
    n = len(mate)
    tail, found = 0, 0
    for t in range(n):
        root[t], dead[t] = 0, False
        if mate[t] < 0:
            root[t] = t + 1
            queue[tail] = t
            tail += 1
    alive, head = tail, 0
    while head < tail and alive > 1:
        t = queue[head]
        head += 1
        r = root[t]
        for e in range(3 * t, 3 * t + 3):
            if dead[r - 1] or twin[e] < 0:
                continue
            u = twin[e] // 3
            if root[u] == 0:
                w = mate[u]
                root[u], root[w], parent[u] = -r, r, t
                queue[tail] = w
                tail += 1
            elif root[u] > 0 and root[u] != r and not dead[root[u] - 1]:
                dead[r - 1] = dead[root[u] - 1] = True
                _flip_up(t, mate, parent)
                _flip_up(u, mate, parent)
                mate[t], mate[u] = u, t
                found += 1
                alive -= 2
    return found
