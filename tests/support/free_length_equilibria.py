"""Equilibria with free lengths, by Newton's method from a grid."""

from __future__ import annotations

from math import cos, hypot, pi, sin


def free_length_equilibria(*values: float) -> int:
    """Different equilibria for (rho, L1, L2, l0, f3, f4), found by Newton's method from a grid; all
    of them regular.
    """
    rho, length1, length2, l0, f3, f4 = values

    def gradient(a: float, b: float) -> tuple[float, float]:
        d1 = (rho - length2 * cos(b), length2 * sin(b))
        d2 = (rho - length1 * cos(a), -length1 * sin(a))
        d3 = (d1[0] - length1 * cos(a), d1[1] - length1 * sin(a))
        m1, m2, m3 = (1 - l0 / hypot(*d) for d in (d1, d2, d3))
        s12 = sin(a + b)
        return (
            m2 * rho * sin(a) + m3 * (rho * sin(a) - length2 * s12) - f3 * cos(a),
            m1 * rho * sin(b) + m3 * (rho * sin(b) - length1 * s12) - f4 * cos(b),
        )

    found: list[tuple[float, float]] = []
    h = 1e-6
    for i in range(24):
        for j in range(24):
            a, b = (i + 0.3) * pi / 12, (j + 0.6) * pi / 12
            for _ in range(30):
                g = gradient(a, b)
                p = [
                    (x - y) / (2 * h)
                    for x, y in zip(gradient(a + h, b), gradient(a - h, b), strict=True)
                ]
                q = [
                    (x - y) / (2 * h)
                    for x, y in zip(gradient(a, b + h), gradient(a, b - h), strict=True)
                ]
                det = p[0] * q[1] - p[1] * q[0]
                if abs(det) < 1e-9:
                    break
                da, db = (g[0] * q[1] - g[1] * q[0]) / det, (p[0] * g[1] - p[1] * g[0]) / det
                a, b = a - da, b - db
                if abs(da) + abs(db) < 1e-13:
                    break
            else:
                continue
            if hypot(*gradient(a, b)) > 1e-10 or abs(det) < 1e-4:
                continue
            if all(hypot(sin((a - x) / 2), sin((b - y) / 2)) > 1e-4 for x, y in found):
                found.append((a, b))
    return len(found)
