/* The fields of a REBOUND simulation that its Rust bindings keep private: gravity, tolerance and the additional force. */
#include "rebound.h"

typedef void (*yorp_force)(void *context, double t, struct reb_particle *particles, unsigned int n);

struct yorp_extras {
    yorp_force force;
    void *context;
};

static void pass_on(struct reb_simulation *r) {
    const struct yorp_extras *extras = r->extras;
    extras->force(extras->context, r->t, r->particles, r->N);
}

/* IAS15 with mutual gravity; the additional force depends on time and positions only. */
void yorp_shed_set_up(struct reb_simulation *r, double gravitational_constant, double epsilon, double t, double dt) {
    r->G = gravitational_constant;
    r->integrator = REB_INTEGRATOR_IAS15;
    r->gravity = REB_GRAVITY_BASIC;
    r->ri_ias15.epsilon = epsilon;
    r->force_is_velocity_dependent = 0;
    r->t = t;
    r->dt = dt;
}

/* One step; `force` is called with `context` at every evaluation and is forgotten afterwards. */
void yorp_shed_step(struct reb_simulation *r, yorp_force force, void *context) {
    struct yorp_extras extras = {force, context};
    r->extras = &extras;
    r->additional_forces = pass_on;
    reb_simulation_step(r);
    r->additional_forces = 0;
    r->extras = 0;
}
