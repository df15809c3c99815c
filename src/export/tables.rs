//! What a run has recorded as tables, in the units of the database: SI and radians.

use super::table::{Column, Table};
use crate::report::RunData;
use crate::store::ConfigurationRecord;

/// All tables of a run; those without rows have only a header.
pub fn tables(run: &RunData) -> Vec<Table> {
    vec![
        legs(run),
        intervals(run),
        settling(run),
        configurations(run),
        torques(run),
        movements(run),
        losses(run),
        fates(run),
        fission(run),
        rigid(run),
    ]
}

fn legs(run: &RunData) -> Table {
    let legs = &run.legs;
    let number = |of: fn(&crate::store::LegRecord) -> f64| Column::number(legs.iter().map(of));
    let whole = |of: fn(&crate::store::LegRecord) -> i64| Column::whole(legs.iter().map(of));
    let columns = vec![
        ("leg", whole(|l| l.leg.into())),
        ("configuration", whole(|l| l.configuration.into())),
        ("t0_s", number(|l| l.t_s[0])),
        ("t1_s", number(|l| l.t_s[1])),
        ("omega0_rad_s", number(|l| l.omega[0])),
        ("omega1_rad_s", number(|l| l.omega[1])),
        ("omega_after_rad_s", number(|l| l.omega_after)),
        ("obliquity0_rad", number(|l| l.obliquity[0])),
        ("obliquity1_rad", number(|l| l.obliquity[1])),
        ("reason", Column::text(legs.iter().map(|l| &l.reason))),
        ("result", Column::text(legs.iter().map(|l| &l.result))),
        ("refinement", whole(|l| l.refinement.into())),
        ("rotations", number(|l| l.dynamics.rotations)),
        ("collisions", whole(|l| l.dynamics.collisions as i64)),
        ("moved", whole(|l| l.moved[0].into())),
        ("shed", whole(|l| l.shed.into())),
        ("settled", whole(|l| l.settled.into())),
        ("non_axial", number(|l| l.non_axial)),
        ("angular_momentum0_kg_m2_s", number(|l| l.angular_momentum.start)),
        ("angular_momentum_torque_kg_m2_s", number(|l| l.angular_momentum.torque)),
        ("angular_momentum_shed_kg_m2_s", number(|l| l.angular_momentum.shed)),
        ("angular_momentum1_kg_m2_s", number(|l| l.angular_momentum.end)),
        ("angular_momentum_over_spin", number(|l| l.angular_momentum.over_spin)),
        ("spin_error", number(|l| l.spin_error)),
        ("obliquity_error_rad", number(|l| l.obliquity_error)),
        ("max_overlap_radii", number(|l| l.dynamics.max_overlap_radii)),
        ("momentum_drift", number(|l| l.dynamics.momentum_drift)),
        ("angular_momentum_drift", number(|l| l.dynamics.angular_momentum_drift)),
    ];
    Table { name: "legs", columns }
}

/// The intervals that a movement has closed.
fn intervals(run: &RunData) -> Table {
    let intervals = &run.intervals;
    let number = |of: fn(&crate::store::IntervalRecord) -> f64| Column::number(intervals.iter().map(of));
    let columns = vec![
        ("interval", Column::whole(intervals.iter().map(|i| i.interval))),
        ("configuration", Column::whole(intervals.iter().map(|i| i.configuration))),
        ("legs", Column::whole(intervals.iter().map(|i| i.legs))),
        ("t0_s", number(|i| i.t_s[0])),
        ("t1_s", number(|i| i.t_s[1])),
        ("omega0_rad_s", number(|i| i.omega[0])),
        ("omega1_rad_s", number(|i| i.omega[1])),
        ("obliquity0_rad", number(|i| i.obliquity[0])),
        ("obliquity1_rad", number(|i| i.obliquity[1])),
    ];
    Table { name: "intervals", columns }
}

fn settling(run: &RunData) -> Table {
    let blocks = &run.settling;
    let columns = vec![
        ("block", Column::whole(blocks.iter().map(|b| b.block))),
        ("period_s", Column::number(blocks.iter().map(|b| b.period_s))),
        ("rotations", Column::number(blocks.iter().map(|b| b.dynamics.rotations))),
        ("moved", Column::whole(blocks.iter().map(|b| b.moved))),
        ("max_displacement_radii", Column::number(blocks.iter().map(|b| b.max_displacement_radii))),
        ("b1_b_over_a", Column::number(blocks.iter().map(|b| b.b_over_a))),
        ("b1_c_over_a", Column::number(blocks.iter().map(|b| b.c_over_a))),
        ("momentum_drift", Column::number(blocks.iter().map(|b| b.dynamics.momentum_drift))),
        ("angular_momentum_drift", Column::number(blocks.iter().map(|b| b.dynamics.angular_momentum_drift))),
        ("angular_momentum_kg_m2_s", Column::number(blocks.iter().map(|b| b.angular_momentum))),
        ("non_axial", Column::number(blocks.iter().map(|b| b.non_axial))),
        ("shed", Column::whole(blocks.iter().map(|b| b.shed))),
    ];
    Table { name: "settling", columns }
}

fn configurations(run: &RunData) -> Table {
    let number = |of: fn(&ConfigurationRecord) -> f64| Column::number(run.configurations.iter().map(of));
    let columns = vec![
        ("configuration", Column::whole(run.configurations.iter().map(|c| c.configuration))),
        ("after_leg", Column::optional_whole(run.configurations.iter().map(|c| c.after_leg))),
        ("t_s", number(|c| c.t_s)),
        ("spheres", Column::whole(run.configurations.iter().map(|c| c.sphere_ids.len() as i64))),
        ("mass_kg", number(|c| c.mass_kg)),
        ("moment_a_kg_m2", number(|c| c.moments_kg_m2[0])),
        ("moment_b_kg_m2", number(|c| c.moments_kg_m2[1])),
        ("moment_c_kg_m2", number(|c| c.moments_kg_m2[2])),
        ("b1_a_m", number(|c| c.b1_axes_m[0])),
        ("b1_b_m", number(|c| c.b1_axes_m[1])),
        ("b1_c_m", number(|c| c.b1_axes_m[2])),
        ("b2_a_m", number(|c| c.b2_axes_m[0])),
        ("b2_b_m", number(|c| c.b2_axes_m[1])),
        ("b2_c_m", number(|c| c.b2_axes_m[2])),
        ("density_b1_kg_m3", number(|c| c.densities_kg_m3[0])),
        ("density_b2_kg_m3", number(|c| c.densities_kg_m3[1])),
        ("density_b3_kg_m3", number(|c| c.densities_kg_m3[2])),
        ("density_b4_kg_m3", number(|c| c.densities_kg_m3[3])),
        ("spin_torque_error_n_m", number(|c| c.torque.spin_torque_error)),
        ("obliquity_torque_error_n_m", number(|c| c.torque.obliquity_torque_error)),
    ];
    Table { name: "configurations", columns }
}

/// One row for each node of each configuration's torque table.
fn torques(run: &RunData) -> Table {
    let nodes = || {
        run.configurations.iter().flat_map(|c| {
            let obliquities = c.torque.obliquity.len();
            (0..c.torque.spin_torque.len()).map(move |node| (c, node, node / obliquities, node % obliquities))
        })
    };
    let columns = vec![
        ("configuration", Column::whole(nodes().map(|(c, ..)| c.configuration))),
        ("omega_rad_s", Column::number(nodes().map(|(c, _, row, _)| c.torque.spin_rate[row]))),
        ("obliquity_rad", Column::number(nodes().map(|(c, _, _, column)| c.torque.obliquity[column]))),
        ("spin_torque_n_m", Column::number(nodes().map(|(c, node, ..)| c.torque.spin_torque[node]))),
        ("obliquity_torque_n_m", Column::number(nodes().map(|(c, node, ..)| c.torque.obliquity_torque[node]))),
    ];
    Table { name: "torques", columns }
}

fn movements(run: &RunData) -> Table {
    let all =
        || run.movements.iter().enumerate().flat_map(|(configuration, of)| of.iter().map(move |m| (configuration, m)));
    let columns = vec![
        ("configuration", Column::whole(all().map(|(configuration, _)| configuration as i64))),
        ("sphere", Column::whole(all().map(|(_, m)| m.sphere))),
        ("displacement_m", Column::number(all().map(|(_, m)| m.displacement_m))),
        ("enclosed_mass_fraction", Column::number(all().map(|(_, m)| m.enclosed_mass_fraction))),
    ];
    Table { name: "movements", columns }
}

fn losses(run: &RunData) -> Table {
    let losses = || run.losses.iter().map(|(_, loss)| loss);
    let component =
        |of: fn(&crate::store::LossRecord) -> [f64; 3], k: usize| Column::number(losses().map(move |l| of(l)[k]));
    let columns = vec![
        ("leg", Column::optional_whole(run.losses.iter().map(|(leg, _)| *leg))),
        ("sphere", Column::whole(losses().map(|l| l.sphere))),
        ("mass_kg", Column::number(losses().map(|l| run.sphere_mass_kg[l.sphere as usize]))),
        ("t_s", Column::number(losses().map(|l| l.t_s))),
        ("omega_rad_s", Column::number(losses().map(|l| l.omega))),
        ("x_m", component(|l| l.position, 0)),
        ("y_m", component(|l| l.position, 1)),
        ("z_m", component(|l| l.position, 2)),
        ("vx_m_s", component(|l| l.velocity, 0)),
        ("vy_m_s", component(|l| l.velocity, 1)),
        ("vz_m_s", component(|l| l.velocity, 2)),
        ("energy_j", Column::number(losses().map(|l| l.energy_j))),
    ];
    Table { name: "losses", columns }
}

fn fates(run: &RunData) -> Table {
    let fates = || run.fates.iter().map(|(_, fate)| fate);
    let orbit = |k: usize| Column::optional(fates().map(move |f| f.orbit.map(|orbit| orbit[k])));
    let columns = vec![
        ("leg", Column::optional_whole(run.fates.iter().map(|(leg, _)| *leg))),
        ("sphere", Column::whole(fates().map(|f| f.sphere))),
        ("fate", Column::text(fates().map(|f| &f.fate))),
        ("t_s", Column::number(fates().map(|f| f.t_s))),
        ("speed_m_s", Column::optional(fates().map(|f| f.speed_m_s))),
        ("semimajor_axis_m", orbit(0)),
        ("eccentricity", orbit(1)),
        ("inclination_rad", orbit(2)),
        ("into_sphere", Column::optional_whole(fates().map(|f| f.into))),
        ("returned", Column::whole(fates().map(|f| f.returned))),
    ];
    Table { name: "fates", columns }
}

/// One row if the run ended so and the pieces were followed.
fn fission(run: &RunData) -> Table {
    let pieces = || run.fission.iter().map(|(_, fission)| fission);
    let orbit = |k: usize| Column::optional(pieces().map(move |f| f.orbit.map(|orbit| orbit[k])));
    let columns = vec![
        ("leg", Column::optional_whole(run.fission.iter().map(|(leg, _)| *leg))),
        ("body_mass_kg", Column::number(pieces().map(|f| f.mass_kg[0]))),
        ("piece_mass_kg", Column::number(pieces().map(|f| f.mass_kg[1]))),
        ("piece_spheres", Column::whole(pieces().map(|f| f.spheres.len() as i64))),
        ("fate", Column::text(pieces().map(|f| &f.fate))),
        ("t_s", Column::number(pieces().map(|f| f.t_s))),
        ("speed_m_s", Column::optional(pieces().map(|f| f.speed_m_s))),
        ("semimajor_axis_m", orbit(0)),
        ("eccentricity", orbit(1)),
        ("inclination_rad", orbit(2)),
        ("body_spin_rad_s", Column::number(pieces().map(|f| f.spin_rate[0]))),
        ("piece_spin_rad_s", Column::number(pieces().map(|f| f.spin_rate[1]))),
    ];
    Table { name: "fission", columns }
}

fn rigid(run: &RunData) -> Table {
    let columns = vec![
        ("t_s", Column::number(run.rigid.iter().map(|r| r.t_s))),
        ("omega_rad_s", Column::number(run.rigid.iter().map(|r| r.omega))),
        ("obliquity_rad", Column::number(run.rigid.iter().map(|r| r.obliquity))),
    ];
    Table { name: "rigid", columns }
}
