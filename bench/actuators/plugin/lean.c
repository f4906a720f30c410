#include "lean.h"

#include <math.h>
#include <string.h>

#include "vector.h"

void lean_read(Lean* self, const mjModel* m, int load_body) {
  memset(self, 0, sizeof(*self));
  Forces* forces = &self->forces;
  if (m->opt.integrator != mjINT_IMPLICITFAST || !forces_read(forces, m)) {
    return;
  }
  int sites[2 * MAX_STRAIGHT];
  Point ends[2 * MAX_STRAIGHT];
  forces_ends(forces, m, sites);
  self->is_known = tree_read(&self->tree, m, &self->load, load_body, ends, sites, 2 * forces->nstraight);
  forces_join(forces, ends);
}

void lean_learn(Lean* self, const mjModel* m, const mjData* d) {
  if (!self->is_known || self->has_damping) {
    return;
  }
  for (int i = 0; i < m->nactuator; i++) {
    const mjtNum* range = m->actuator_forcerange + 2 * i;
    mjtNum force = d->actuator_force[m->actuator_outadr[i]];
    if (m->actuator_forcelimited[i] && !(force > range[0] && force < range[1])) {
      return;
    }
  }
  const Tree* tree = &self->tree;
  for (int i = 0; i < tree->nlink + tree->nrotor; i++) {
    bool is_link = i < tree->nlink;
    int dof = is_link ? tree->link[i].dof : tree->rotor[i - tree->nlink].dof;
    mjtNum row[MAX_LINKS] = {0};
    for (int k = m->D_rowadr[dof]; k < m->D_rowadr[dof] + m->D_rownnz[dof]; k++) {
      row[m->D_colind[k]] = d->qDeriv[k];
    }
    for (int j = 0; is_link && j <= i; j++) {
      self->damping[i][j] = row[tree->link[j].dof];
    }
    if (!is_link) {
      self->rotor_damping[i - tree->nlink] = row[dof];
    }
  }
  self->has_damping = true;
}

// Whether all is sound, and no joint at a limit.
static bool is_ordinary(const mjModel* m, const mjData* d) {
  for (int i = 0; i < m->nv; i++) {
    mjtNum q = d->qpos[i];
    const mjtNum* range = m->jnt_range + 2 * i;
    if (!(fabs(q) < mjMAXVAL && fabs(d->qvel[i]) < mjMAXVAL) ||
        (m->jnt_limited[i] && !(q - range[0] > m->jnt_margin[i] && range[1] - q > m->jnt_margin[i]))) {
      return false;
    }
  }
  return true;
}

// Solves (M - h * damping) qacc = force - bias, from the tips of the tree to its root: there A = L' D L has no fill.
static void accelerate(const Lean* self, mjtNum h, const mjtNum* force, mjtNum* qacc) {
  const Tree* tree = &self->tree;
  int n = tree->nlink;
  mjtNum A[MAX_LINKS][MAX_LINKS], x[MAX_LINKS], inverse[MAX_LINKS];
  for (int i = 0; i < n; i++) {
    x[i] = force[tree->link[i].dof] - tree->bias[i];
    for (int j = i; j >= 0; j = tree->link[j].parent) {
      A[i][j] = tree->M[i][j] - h * self->damping[i][j];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    inverse[k] = 1 / A[k][k];
    for (int i = tree->link[k].parent; i >= 0; i = tree->link[i].parent) {
      mjtNum factor = A[k][i] * inverse[k];
      for (int j = i; j >= 0; j = tree->link[j].parent) {
        A[i][j] -= factor * A[k][j];
      }
      x[i] -= factor * x[k];
      A[k][i] = factor;
    }
  }
  for (int k = 0; k < n; k++) {
    x[k] *= inverse[k];
    for (int j = tree->link[k].parent; j >= 0; j = tree->link[j].parent) {
      x[k] -= A[k][j] * x[j];
    }
    qacc[tree->link[k].dof] = x[k];
  }
  for (int i = 0; i < tree->nrotor; i++) {
    int dof = tree->rotor[i].dof;
    qacc[dof] = force[dof] / (tree->rotor[i].inertia - h * self->rotor_damping[i]);
  }
}

bool lean_step(Lean* self, const mjModel* m, mjData* d, const mjtNum* push) {
  mjtNum force[MAX_LINKS];
  if (!self->is_known || !self->has_damping || !is_ordinary(m, d)) {
    return false;
  }
  tree_bias(&self->tree, m, d, NULL, &self->load, push);
  tree_inertia(&self->tree);
  if (!forces_update(&self->forces, &self->tree, m, d, force)) {
    return false;
  }
  accelerate(self, m->opt.timestep, force, d->qacc);
  for (int i = 0; i < m->nv; i++) {
    if (!(fabs(d->qacc[i]) < mjMAXVAL)) {
      return false;
    }
  }
  forces_advance(&self->forces, m, d);
  return true;
}
