#include "undriven.h"

#include <string.h>

#include "vector.h"

static bool is_among(int value, const int32_t* values, int count) {
  for (int i = 0; i < count; i++) {
    if (values[i] == value) {
      return true;
    }
  }
  return false;
}

// Whether the servos are all that drives beside plugins, and no plugin is cut off at a largest force.
static bool is_simple(const mjModel* m, const int32_t* servo, int n) {
  for (int i = 0; i < m->nactuator; i++) {
    bool is_plugin = m->actuator_plugin[i] >= 0;
    if (is_plugin ? m->actuator_forcelimited[i] : !is_among(i, servo, n)) {
      return false;
    }
  }
  return true;
}

void undriven_read(Undriven* self, const mjModel* m, int load_body, const int32_t* servo, int n, const int32_t* site,
                   int nsite) {
  memset(self, 0, sizeof(*self));
  if (nsite > MAX_SITES || !is_simple(m, servo, n) || !forces_read(&self->forces, m)) {
    return;
  }
  int sites[MAX_SITES + 2 * MAX_STRAIGHT];
  Point points[MAX_SITES + 2 * MAX_STRAIGHT];
  memcpy(sites, site, (size_t)nsite * sizeof(int));
  forces_ends(&self->forces, m, sites + nsite);
  int count = nsite + 2 * self->forces.nstraight;
  self->is_known = tree_read(&self->tree, m, &self->load, load_body, points, sites, count);
  forces_join(&self->forces, points + nsite);
  memcpy(self->site, points, (size_t)nsite * sizeof(Point));
}

void undriven_begin(const mjModel* m, mjData* d) {
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_tendon(m, d);
  mj_transmission(m, d);
}

void undriven_update(Undriven* self, const mjModel* m, mjData* d, const mjtNum* push, mjtNum* outside) {
  tree_bias(&self->tree, m, d, d->qacc, &self->load, push);
  forces_undriven(&self->forces, &self->tree, m, d);
  zero(outside, (int)m->nv);
  for (int i = 0; i < self->tree.nlink; i++) {
    outside[self->tree.link[i].dof] = -self->tree.bias[i];
  }
}

void undriven_site(const Undriven* self, int i, mjtNum result[3]) {
  tree_point(&self->tree, self->site + i, result);
}
