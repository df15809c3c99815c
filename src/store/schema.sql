-- Tables of a run database. Everything that is not a function of scene and build lives in meta_* tables;
-- all other tables are equal for equal runs. Blobs are little-endian arrays, row-major; lengths in m, SI throughout.
-- A STRICT table refuses a value of another type.

CREATE TABLE run (
    key   TEXT PRIMARY KEY,          -- 'scene' (JSON with every default filled in), 'version' (build)
    value TEXT NOT NULL
) STRICT;

-- What the next turn of the loop starts from: exactly one row.
CREATE TABLE state (
    id            INTEGER PRIMARY KEY CHECK (id = 1),
    stage         TEXT NOT NULL,     -- 'built', 'settled', 'evolving', 'finished'
    outcome       TEXT,              -- once finished: spun_down, fission, disrupted
    blocks        INTEGER NOT NULL,  -- settling blocks done
    leg           INTEGER NOT NULL,  -- legs done
    configuration INTEGER NOT NULL,  -- present configuration (-1 before object 0)
    refinement    INTEGER NOT NULL,  -- how often the spin increment has been cut to a fifth
    t_s           REAL NOT NULL,     -- evolution time, s
    omega         REAL NOT NULL,     -- spin rate, rad/s
    obliquity     REAL NOT NULL,     -- rad
    spheres       BLOB NOT NULL,     -- f64, 11 columns of N: x y z vx vy vz wx wy wz mass radius, inertial frame
    sphere_ids    BLOB NOT NULL,     -- u32, N: row of each sphere in table sphere
    rest          BLOB,              -- f64, 3 x N: x, y, z of the spheres when last seen at rest; null for full questions
    normal_stiffness_n_m REAL,       -- of soft contacts, found at the start of the run; null for hard spheres
    contact_rows  BLOB,              -- u32, C x 2: rows of `spheres` that touch; null for hard spheres, as the next
    contacts      BLOB               -- f64, C x 8: what each contact remembers: sliding spring (3), m; rolling spring (3),
                                     -- rad; twisting spring, rad; age, s; inertial frame, of the second against the first
) STRICT;

CREATE TABLE sphere (
    sphere   INTEGER PRIMARY KEY,
    mass_kg  REAL NOT NULL,
    radius_m REAL NOT NULL
) STRICT;

-- The body as it was made, before settling, without what was far from the rest: one row.
CREATE TABLE built (
    id               INTEGER PRIMARY KEY CHECK (id = 1),
    b1_b_over_a      REAL NOT NULL,
    b1_c_over_a      REAL NOT NULL,
    density_b1_kg_m3 REAL NOT NULL,
    period_s         REAL NOT NULL
) STRICT;

CREATE TABLE settling (
    block                    INTEGER PRIMARY KEY,
    rotations                REAL NOT NULL,
    period_s                 REAL NOT NULL,     -- at the block's start
    moved                    INTEGER NOT NULL,  -- spheres displaced beyond the movement limit in this block
    max_displacement_radii   REAL NOT NULL,
    b1_b_over_a              REAL NOT NULL,     -- at the block's end
    b1_c_over_a              REAL NOT NULL,
    collisions               INTEGER NOT NULL,
    slide_rule               INTEGER NOT NULL,
    collapse_rule            INTEGER NOT NULL,
    capped                   INTEGER NOT NULL,
    momentum_drift           REAL NOT NULL,     -- over sum m|v|
    angular_momentum_drift   REAL NOT NULL,     -- relative, of the block's dynamics
    angular_momentum         REAL NOT NULL,     -- at the block's end, kg m^2/s
    non_axial                REAL NOT NULL,     -- |L across the axis of largest moment| / |L| before the body is aligned
    shed                     INTEGER NOT NULL   -- spheres removed at the block's end
) STRICT;

-- Connectivity shared by every tiling of the run.
CREATE TABLE tiling (
    id                INTEGER PRIMARY KEY CHECK (id = 1),
    facets            BLOB NOT NULL,            -- u32, F x 3
    ellipsoid_axes_m  BLOB NOT NULL,            -- f64, 3: the original equivalent ellipsoid
    frame_rotation    BLOB NOT NULL             -- f64, 3 x 3: inertial to original frame at object 0
) STRICT;

CREATE TABLE configuration (
    configuration       INTEGER PRIMARY KEY,
    after_leg           INTEGER NOT NULL,       -- leg whose check produced it (-1: object 0)
    t_s                 REAL NOT NULL,
    mass_kg             REAL NOT NULL,
    sphere_ids          BLOB NOT NULL,          -- u32, N
    positions           BLOB NOT NULL,          -- f64, N x 3, original frame; spheres that only rattled keep their earlier rows exactly
    body_axes           BLOB NOT NULL,          -- f64, 3 x 3: original frame to body frame (x long, z spin)
    centre_of_mass      BLOB NOT NULL,          -- f64, 3, original frame
    moments_kg_m2       BLOB NOT NULL,          -- f64, A <= B <= C
    b1_axes_m           BLOB NOT NULL,          -- f64, 3: dynamically equivalent ellipsoid
    b2_axes_m           BLOB NOT NULL,          -- f64, 3: half extents
    density_b1_kg_m3    REAL NOT NULL,
    density_b2_kg_m3    REAL NOT NULL,
    density_b3_kg_m3    REAL NOT NULL,          -- convex hull of the spheres
    density_b4_kg_m3    REAL NOT NULL,          -- volume inside the tiling
    vertices            BLOB NOT NULL,          -- f64, V x 3, original frame
    vertices_kept       INTEGER NOT NULL,       -- vertices equal to the previous configuration's
    vertices_flagged    INTEGER NOT NULL,       -- fallback direction taken
    facets_folded       INTEGER NOT NULL,
    obliquity           BLOB NOT NULL,          -- f64, K: nodes, rad
    spin_rate           BLOB NOT NULL,          -- f64, W: nodes, rad/s
    spin_torque         BLOB NOT NULL,          -- f64, W x K, N m
    obliquity_torque    BLOB NOT NULL,          -- f64, W x K, N m
    spin_torque_error   REAL NOT NULL,          -- N m
    obliquity_torque_error REAL NOT NULL        -- N m
) STRICT;

CREATE TABLE leg (
    leg               INTEGER PRIMARY KEY,
    configuration     INTEGER NOT NULL,         -- whose torques drove it
    t0_s              REAL NOT NULL,
    t1_s              REAL NOT NULL,
    omega0            REAL NOT NULL,
    omega1            REAL NOT NULL,            -- at t1, before any movement
    obliquity0        REAL NOT NULL,
    obliquity1        REAL NOT NULL,
    reason            TEXT NOT NULL,            -- why the leg ended: spin_change, extremum, stop_period, cycle_end
    refinement        INTEGER NOT NULL,
    rk4_steps         INTEGER NOT NULL,
    spin_error        REAL NOT NULL,            -- step-doubling estimate, relative
    obliquity_error   REAL NOT NULL,            -- rad
    result            TEXT NOT NULL,            -- quiet, movement, backtracked, stopped
    omega_after       REAL NOT NULL,            -- spin rate the next leg starts from
    rotations         REAL NOT NULL,            -- rotations of dynamics
    collisions        INTEGER NOT NULL,
    slide_rule        INTEGER NOT NULL,
    collapse_rule     INTEGER NOT NULL,
    capped            INTEGER NOT NULL,
    max_overlap_radii REAL NOT NULL,
    moved             INTEGER NOT NULL,         -- by the scene's movement rule
    moved_robust      INTEGER NOT NULL,
    moved_literal     INTEGER NOT NULL,
    settled           INTEGER NOT NULL,         -- 0: still moving after max_rotations
    non_axial         REAL NOT NULL,            -- |L across the axis of largest moment| / |L|, before the body is aligned
    angular_momentum0 REAL NOT NULL,            -- |L| of the spheres before the leg, kg m^2/s
    angular_momentum_torque REAL NOT NULL,      -- given by sunlight along L: C of the configuration (omega1 - omega0)
    angular_momentum_shed REAL NOT NULL,        -- change of |L| with what left, pulled in flight and came back
    angular_momentum1 REAL NOT NULL,            -- |L| of the spheres after the leg
    angular_momentum_over_spin REAL NOT NULL,   -- angular_momentum1 / (C omega_after): 1
    momentum_drift    REAL NOT NULL,            -- over sum m|v|
    angular_momentum_drift REAL NOT NULL,
    shed              INTEGER NOT NULL
) STRICT;

-- Time between two movements: one or many legs with the same configuration.
CREATE TABLE interval (
    interval      INTEGER PRIMARY KEY,
    configuration INTEGER NOT NULL,
    legs          INTEGER NOT NULL,
    t0_s          REAL NOT NULL,
    t1_s          REAL NOT NULL,
    omega0        REAL NOT NULL,
    omega1        REAL NOT NULL,
    obliquity0    REAL NOT NULL,
    obliquity1    REAL NOT NULL
) STRICT;

CREATE TABLE movement (
    configuration          INTEGER NOT NULL,    -- the configuration that came out of it
    sphere                 INTEGER NOT NULL,
    displacement_m         REAL NOT NULL,
    enclosed_mass_fraction REAL NOT NULL,       -- before the movement
    PRIMARY KEY (configuration, sphere)
) STRICT, WITHOUT ROWID;

CREATE TABLE loss (
    leg      INTEGER NOT NULL,                  -- leg whose check shed it (-1: settling)
    sphere   INTEGER NOT NULL,
    t_s      REAL NOT NULL,
    omega    REAL NOT NULL,                     -- spin rate at the leg's end
    position BLOB NOT NULL,                     -- f64, 3, body-centred inertial frame
    velocity BLOB NOT NULL,                     -- f64, 3
    spin     BLOB NOT NULL,                     -- f64, 3
    energy_j REAL NOT NULL,                  -- two-body energy of its cluster relative to the main body
    PRIMARY KEY (leg, sphere)
) STRICT, WITHOUT ROWID;

-- What became of a sphere that left, if the scene asks for it; vectors in the inertial axes in which it left.
CREATE TABLE fate (
    id               INTEGER PRIMARY KEY,
    leg              INTEGER NOT NULL,          -- leg whose check shed it (-1: settling)
    sphere           INTEGER NOT NULL,
    fate             TEXT NOT NULL,             -- reimpact, escape, bound, merged
    t_s              REAL NOT NULL,             -- after it left
    speed_m_s        REAL,                      -- at contact, or at infinity
    position         BLOB,                      -- f64, 3: where it struck the body, at the place's position when it left, m
    orbit            BLOB,                      -- f64, 3: mean a (m), e, i (rad to the equator) while bound
    within_3_radii   REAL,                      -- share of the time that it spent there
    into_sphere      INTEGER,                   -- the one it merged with
    returned         INTEGER NOT NULL,          -- 1: went back to the body and is not in table loss
    angular_momentum BLOB                       -- f64, 3: what it took away from the body; null if it came back or merged
) STRICT;

-- How the pieces of a fission went on, if the scene asks for it.
CREATE TABLE fission (
    leg       INTEGER PRIMARY KEY,
    mass_kg   BLOB NOT NULL,                    -- f64, 2: the body, the piece that left
    spheres   BLOB NOT NULL,                    -- u32: those of the piece that left
    fate      TEXT NOT NULL,                    -- collided, separated, bound
    t_s       REAL NOT NULL,                    -- after they parted
    speed_m_s REAL,                             -- at contact, or at infinity
    orbit     BLOB,                             -- f64, 3: mean a (m), e, i (rad) while bound
    spin_rate BLOB NOT NULL                     -- f64, 2: at the end, rad/s
) STRICT;

-- The body of object 0, were it rigid.
CREATE TABLE rigid (
    sample    INTEGER PRIMARY KEY,
    t_s       REAL NOT NULL,
    omega     REAL NOT NULL,
    obliquity REAL NOT NULL
) STRICT;

-- Where the run stands after its last leg, once it has been brought to a requested time or cannot go on: at most one row.
CREATE TABLE ending (
    id        INTEGER PRIMARY KEY CHECK (id = 1),
    t_s       REAL NOT NULL,
    omega     REAL NOT NULL,
    obliquity REAL NOT NULL,
    outcome   TEXT NOT NULL              -- end_time, until, spun_down, fission, disrupted
) STRICT;

CREATE TABLE meta_session (
    session        INTEGER PRIMARY KEY,
    started_unix_s INTEGER NOT NULL,
    host           TEXT NOT NULL,
    threads        INTEGER NOT NULL,
    version        TEXT NOT NULL,
    processor      TEXT NOT NULL,               -- its name, and the level of vector instructions in use
    seconds        REAL NOT NULL,               -- wall time to the last transaction
    cpu_seconds    REAL NOT NULL
) STRICT;

CREATE TABLE meta_part (
    session     INTEGER NOT NULL,
    part        TEXT NOT NULL,
    seconds     REAL NOT NULL,
    cpu_seconds REAL NOT NULL,
    count       INTEGER NOT NULL,
    PRIMARY KEY (session, part)
) STRICT, WITHOUT ROWID;
