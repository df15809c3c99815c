#!/usr/bin/env python3
"""Draw a run: python3 docs/plot_run.py DIR OUT.png

Spin and obliquity against time with one colour per configuration (rigid body in black), the torque curves of all
configurations, and the latest aggregate seen along the spin axis with the spheres of the last movement marked.
"""
import sqlite3
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

MYR_S, REV_PER_DAY = 3.15576e13, 2 * np.pi / 86400
directory, out = sys.argv[1:3]
db = sqlite3.connect(f"file:{directory}/run.sqlite?mode=ro", uri=True)
legs = np.array(db.execute("SELECT configuration, t0_s, t1_s, omega0, omega1, obliquity0, obliquity1 FROM leg "
                           "WHERE result <> 'backtracked' ORDER BY leg").fetchall())
rigid = np.array(db.execute("SELECT t_s, omega, obliquity FROM rigid ORDER BY sample").fetchall())
shapes = db.execute("SELECT configuration, obliquity, spin_torque, obliquity_torque, moments_kg_m2 FROM configuration "
                    "ORDER BY configuration").fetchall()
colour = plt.get_cmap("viridis", max(len(shapes), 2))

figure, axes = plt.subplots(2, 3, figsize=(13, 7), constrained_layout=True, width_ratios=[1.2, 1, 1])
end = legs[-1, 2] / MYR_S
for row, (first, label, unit) in enumerate([(3, "spin rate (rev/day)", 1 / REV_PER_DAY), (5, "obliquity (deg)", 180 / np.pi)]):
    ax = axes[row, 0]
    shown = rigid[:, 0] <= legs[-1, 2] * 1.001
    ax.plot(rigid[shown, 0] / MYR_S, rigid[shown, 1 + row] * unit, "k", lw=1, label="rigid")
    for leg in legs:
        ax.plot(leg[1:3] / MYR_S, leg[first:first + 2] * unit, color=colour(int(leg[0])), lw=2.5)
    ax.set(xlabel="time (Myr)", ylabel=label, xlim=(0, end))
    ax.legend(frameon=False)
for configuration, eps, spin, obliquity, moments in shapes:
    eps, c = np.degrees(np.frombuffer(eps)), np.frombuffer(moments)[2]
    for row, torque in enumerate((spin, obliquity)):
        axes[row, 1].plot(eps, np.frombuffer(torque)[:len(eps)] / c * 1e18, color=colour(configuration), lw=1)
for row, label in enumerate((r"$T_\omega/C$", r"$T_\epsilon/C$")):
    axes[row, 1].axhline(0, color="k", lw=0.5)
    axes[row, 1].set(xlabel="obliquity (deg)", ylabel=label + r" ($10^{-18}$ s$^{-2}$)", xlim=(0, 180))

configuration, ids, positions, axes_blob, centre = db.execute(
    "SELECT configuration, sphere_ids, positions, body_axes, centre_of_mass FROM configuration "
    "ORDER BY configuration DESC LIMIT 1").fetchone()
body = (np.frombuffer(positions).reshape(-1, 3) - np.frombuffer(centre)) @ np.frombuffer(axes_blob).reshape(3, 3).T
ids = np.frombuffer(ids, "<u4")
radius = dict(db.execute("SELECT sphere, radius_m FROM sphere"))
moved = {s for s, in db.execute("SELECT sphere FROM movement WHERE configuration = ?", (configuration,))}
for ax, (i, j, k), names in ((axes[0, 2], (0, 1, 2), "xy"), (axes[1, 2], (0, 2, 1), "xz")):
    for n in np.argsort(body[:, k] * (1 if k == 2 else -1)):
        shade = 0.35 + 0.5 * (body[n, k] * (1 if k == 2 else -1) - body[:, k].min()) / np.ptp(body[:, k])
        face = "tab:red" if ids[n] in moved else str(min(max(shade, 0), 1))
        ax.add_patch(plt.Circle(body[n, [i, j]], radius[ids[n]], fc=face, ec="k", lw=0.3))
    ax.set(aspect="equal", xlabel=f"{names[0]} (m)", ylabel=f"{names[1]} (m)",
           title=f"configuration {configuration}, moved spheres red" if k == 2 else None)
    ax.autoscale_view()
figure.savefig(out, dpi=80)
