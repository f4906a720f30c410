#include "track.h"

#include <math.h>
#include <string.h>

#include "tree.h"

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

// A spatial tendon that runs straight between two sites.
typedef struct Straight {
  int tendon;
  Point from, to;
} Straight;

enum { MAX_STRAIGHT = 8 };

typedef struct Track {
  bool is_known;    // whether this file can step the model
  bool has_slopes;  // whether `slopes` are those of the model
  Tree tree;
  Point load;
  int nstraight;
  Straight straight[MAX_STRAIGHT];
  mjtNum slopes[MAX_LINKS][MAX_LINKS];  // derivative of forces with respect to velocities, lower triangle
  mjtNum rotor_slopes[MAX_LINKS];
} Track;

static bool any(const mjtNum* values, mjtSize count) {
  for (mjtSize i = 0; i < count; i++) {
    if (values[i] != 0) {
      return true;
    }
  }
  return false;
}

// Whether nothing can touch, rub, be tied, be delayed, float or sleep.
static bool is_free(const mjModel* m) {
  bool odd = m->neq || m->npair || m->nmocap || m->nflex || m->nhistory || m->ngravcomp || m->opt.density != 0 ||
             m->opt.viscosity != 0 || m->opt.disableflags || m->opt.enableflags ||
             m->opt.integrator != mjINT_IMPLICITFAST || any(m->dof_frictionloss, m->nv) ||
             any(m->tendon_frictionloss, m->ntendon) || any(m->tendon_armature, m->ntendon);
  for (int i = 0; i < m->ngeom; i++) {
    odd = odd || m->geom_contype[i] || m->geom_conaffinity[i];
  }
  for (int i = 0; i < m->njnt; i++) {
    odd = odd || m->jnt_actfrclimited[i];
  }
  for (int i = 0; i < m->ntendon; i++) {
    odd = odd || m->tendon_limited[i] || m->tendon_actfrclimited[i];
  }
  return !odd;
}

// Whether the derivative of all forces with respect to velocities is constant, as long as no actuator is at its limit.
static bool has_constant_slopes(const mjModel* m) {
  bool odd = any(m->dof_dampingpoly, mjNPOLY * m->nv) || any(m->tendon_dampingpoly, mjNPOLY * m->ntendon) ||
             any(m->actuator_armature, m->nactuator) || any(m->actuator_damping, m->nactuator) ||
             any(m->actuator_dampingpoly, mjNPOLY * m->nactuator);
  for (int i = 0; i < m->nactuator; i++) {
    int gain = m->actuator_gaintype[i], bias = m->actuator_biastype[i], dynamics = m->actuator_dyntype[i];
    odd = odd || (gain != mjGAIN_FIXED && gain != mjGAIN_PID) || (bias != mjBIAS_NONE && bias != mjBIAS_AFFINE) ||
          (dynamics != mjDYN_NONE && dynamics != mjDYN_PID);
    odd = odd || (m->actuator_trntype[i] != mjTRN_JOINT && m->actuator_trntype[i] != mjTRN_TENDON);
  }
  for (int i = 0; i < m->nplugin; i++) {
    odd = odd || mjp_getPluginAtSlot(m->plugin[i])->capabilityflags != mjPLUGIN_ACTUATOR;
  }
  return !odd;
}

// Whether something pulls along a tendon with a force that depends on its velocity; plugins have no derivative.
static bool is_damped(const mjModel* m, int tendon) {
  bool damped = m->tendon_damping[tendon] != 0;
  for (int i = 0; i < m->nactuator; i++) {
    bool acts = m->actuator_trntype[i] == mjTRN_TENDON && m->actuator_trnid[2 * i] == tendon;
    damped = damped || (acts && m->actuator_plugin[i] < 0);
  }
  return damped;
}

EXPORTED int64_t track_size(void) {
  return (int64_t)sizeof(Track);
}

EXPORTED int track_prepare(void* memory, const mjModel* m, int64_t load_body) {
  Track* self = memory;
  memset(self, 0, sizeof(*self));
  if (!is_free(m) || !has_constant_slopes(m)) {
    return 0;
  }
  int sites[2 * MAX_STRAIGHT];
  Point points[2 * MAX_STRAIGHT];
  for (int i = 0; i < m->ntendon; i++) {
    const int* wrap = m->wrap_type + m->tendon_adr[i];
    if (wrap[0] == mjWRAP_JOINT) {
      continue;
    }
    bool straight = m->tendon_num[i] == 2 && wrap[0] == mjWRAP_SITE && wrap[1] == mjWRAP_SITE;
    if (!straight || self->nstraight == MAX_STRAIGHT || is_damped(m, i)) {
      return 0;
    }
    memcpy(sites + 2 * self->nstraight, m->wrap_objid + m->tendon_adr[i], 2 * sizeof(int));
    self->straight[self->nstraight++].tendon = i;
  }
  if (!tree_read(&self->tree, m, &self->load, (int)load_body, points, sites, 2 * self->nstraight)) {
    return 0;
  }
  for (int i = 0; i < self->nstraight; i++) {
    self->straight[i].from = points[2 * i];
    self->straight[i].to = points[2 * i + 1];
  }
  self->is_known = true;
  return 1;
}

// Whether a joint is at a limit, or something is no sound number: both are MuJoCo's to handle.
static bool needs_care(const mjModel* m, const mjData* d) {
  for (int i = 0; i < m->nv; i++) {
    mjtNum q = d->qpos[i];  // hinges and slides alone: a position for each degree of freedom
    if (!(fabs(q) < mjMAXVAL && fabs(d->qvel[i]) < mjMAXVAL)) {
      return true;
    }
    const mjtNum* range = m->jnt_range + 2 * i;
    if (m->jnt_limited[i] && !(q - range[0] > m->jnt_margin[i] && range[1] - q > m->jnt_margin[i])) {
      return true;
    }
  }
  return false;
}

static bool is_saturated(const mjModel* m, const mjData* d) {
  for (int i = 0; i < m->nactuator; i++) {
    const mjtNum* range = m->actuator_forcerange + 2 * i;
    mjtNum force = d->actuator_force[m->actuator_outadr[i]];
    if (m->actuator_forcelimited[i] && !(force > range[0] && force < range[1])) {
      return true;
    }
  }
  return false;
}

// Takes over the derivatives from a step that MuJoCo did.
static void keep_slopes(Track* self, const mjModel* m, const mjData* d) {
  const Tree* tree = &self->tree;
  mjtNum row[MAX_LINKS];
  for (int i = 0; i < tree->nlink + tree->nrotor; i++) {
    int dof = i < tree->nlink ? tree->link[i].dof : tree->rotor[i - tree->nlink].dof;
    mju_zero(row, MAX_LINKS);
    for (int k = m->D_rowadr[dof]; k < m->D_rowadr[dof] + m->D_rownnz[dof]; k++) {
      row[m->D_colind[k]] = d->qDeriv[k];
    }
    for (int j = 0; j <= i && i < tree->nlink; j++) {
      self->slopes[i][j] = row[tree->link[j].dof];
    }
    if (i >= tree->nlink) {
      self->rotor_slopes[i - tree->nlink] = row[dof];
    }
  }
  self->has_slopes = true;
}

static mjtNum along_row(const mjtNum* values, const int* columns, int count, const mjtNum* vector) {
  mjtNum sum = 0;
  for (int k = 0; k < count; k++) {
    sum += values[k] * vector[columns[k]];
  }
  return sum;
}

static void update_straight(const Track* self, const mjModel* m, mjData* d) {
  for (int i = 0; i < self->nstraight; i++) {
    const Straight* one = self->straight + i;
    int tendon = one->tendon;
    mjtNum from[3], to[3], direction[3], row[MAX_LINKS] = {0};
    tree_point(&self->tree, &one->from, from);
    tree_point(&self->tree, &one->to, to);
    mju_sub3(direction, to, from);
    d->ten_length[tendon] = mju_normalize3(direction);
    tree_jacobian(&self->tree, &one->to, to, direction, 1, row);
    tree_jacobian(&self->tree, &one->from, from, direction, -1, row);
    int first = m->ten_J_rowadr[tendon];
    for (int k = first; k < first + m->ten_J_rownnz[tendon]; k++) {
      d->ten_J[k] = row[m->ten_J_colind[k]];
    }
    for (int a = 0; a < m->nactuator; a++) {
      if (m->actuator_trntype[a] != mjTRN_TENDON || m->actuator_trnid[2 * a] != tendon) {
        continue;
      }
      int out = m->actuator_outadr[a], begin = d->moment_rowadr[out];
      for (int k = begin; k < begin + d->moment_rownnz[out]; k++) {
        d->actuator_moment[k] = m->actuator_gear[6 * out] * row[d->moment_colind[k]];
      }
    }
  }
}

static void update_transmissions(const mjModel* m, mjData* d) {
  for (int i = 0; i < m->ntendon; i++) {
    int first = m->tendon_adr[i];
    if (m->wrap_type[first] == mjWRAP_JOINT) {
      d->ten_length[i] = 0;
      for (int k = first; k < first + m->tendon_num[i]; k++) {
        d->ten_length[i] += m->wrap_prm[k] * d->qpos[m->jnt_qposadr[m->wrap_objid[k]]];
      }
    }
    int row = m->ten_J_rowadr[i];
    d->ten_velocity[i] = along_row(d->ten_J + row, m->ten_J_colind + row, m->ten_J_rownnz[i], d->qvel);
  }
  for (int i = 0; i < m->nactuator; i++) {
    int out = m->actuator_outadr[i], id = m->actuator_trnid[2 * i], row = d->moment_rowadr[out];
    mjtNum length = m->actuator_trntype[i] == mjTRN_JOINT ? d->qpos[m->jnt_qposadr[id]] : d->ten_length[id];
    d->actuator_length[out] = m->actuator_gear[6 * out] * length;
    d->actuator_velocity[out] =
        along_row(d->actuator_moment + row, d->moment_colind + row, d->moment_rownnz[out], d->qvel);
  }
}

// Solves (M - h * slopes) x = force from the tips of the tree to its root.
static void accelerate(const Track* self, mjtNum h, const mjtNum* force, mjtNum* qacc) {
  const Tree* tree = &self->tree;
  int n = tree->nlink;
  mjtNum A[MAX_LINKS][MAX_LINKS], x[MAX_LINKS];
  for (int i = 0; i < n; i++) {
    x[i] = force[tree->link[i].dof] - tree->bias[i];
    for (int j = 0; j <= i; j++) {
      A[i][j] = tree->M[i][j] - h * self->slopes[i][j];
    }
  }
  for (int k = n - 1; k >= 0; k--) {  // A = L' D L with L unit lower, which has no fill in a tree
    for (int i = tree->link[k].parent; i >= 0; i = tree->link[i].parent) {
      mjtNum factor = A[k][i] / A[k][k];
      for (int j = i; j >= 0; j = tree->link[j].parent) {
        A[i][j] -= factor * A[k][j];
      }
      x[i] -= factor * x[k];
      A[k][i] = factor;
    }
  }
  for (int k = 0; k < n; k++) {
    x[k] /= A[k][k];
    for (int j = tree->link[k].parent; j >= 0; j = tree->link[j].parent) {
      x[k] -= A[k][j] * x[j];
    }
    qacc[tree->link[k].dof] = x[k];
  }
  for (int i = 0; i < tree->nrotor; i++) {
    int dof = tree->rotor[i].dof;
    qacc[dof] = force[dof] / (tree->rotor[i].inertia - h * self->rotor_slopes[i]);
  }
}

// One step of `mj_step` without what nothing depends on here. Returns false where that step is MuJoCo's to do.
static bool step(Track* self, const mjModel* m, mjData* d, const mjtNum* push) {
  if (!self->has_slopes || needs_care(m, d)) {
    return false;
  }
  tree_update(&self->tree, m, d, &self->load, push);
  update_straight(self, m, d);
  update_transmissions(m, d);
  mj_passive(m, d);
  mj_fwdActuation(m, d);
  if (is_saturated(m, d)) {
    return false;
  }
  mjtNum force[MAX_LINKS];
  for (int i = 0; i < m->nv; i++) {
    force[i] = d->qfrc_passive[i] + d->qfrc_actuator[i];
  }
  accelerate(self, m->opt.timestep, force, d->qacc);
  for (int i = 0; i < m->nv; i++) {
    if (!(fabs(d->qacc[i]) < mjMAXVAL)) {
      return false;
    }
  }
  mj_Euler(m, d);
  return true;
}

static void set_inputs(mjData* d, const Course* course, int64_t i, mjtNum h, mjtNum* push) {
  int64_t period = i / course->substeps, k = i % course->substeps, n = course->ndrive;
  mjtNum s = h * (mjtNum)k, later = s + course->ahead;
  for (int64_t j = 0; j < n; j++) {
    const mjtNum* c = course->path + period * n + j;
    mjtNum position = c[0], velocity = 0;
    for (int64_t p = 1; p < course->order; p++) {
      velocity = velocity * later + (mjtNum)(course->order - p) * c[(p - 1) * course->pitch];
      position = position * s + c[p * course->pitch];
    }
    d->ctrl[course->servo_ctrl[j]] = position;
    d->ctrl[course->servo_ctrl[j] + 1] = velocity;
  }
  const mjtNum* before = course->wrenches + 6 * period;
  mjtNum blend = (mjtNum)k / (mjtNum)course->substeps;
  for (int j = 0; j < 6; j++) {
    push[j] = before[j] + blend * (before[6 + j] - before[j]);
  }
}

EXPORTED int64_t track_run(void* memory, const mjModel* m, mjData* d, const Course* course) {
  Track* self = memory;
  mjModel blind = *m, plain = *m;  // the same arrays under other options
  blind.opt.disableflags |= mjDSBL_SENSOR;
  plain.opt.disableflags |= mjDSBL_EULERDAMP;
  mju_zero(d->ctrl, (int)m->nu);
  mju_zero(d->xfrc_applied, (int)(6 * m->nbody));
  mju_zero(d->qfrc_applied, (int)m->nv);
  mju_zero(d->qacc_warmstart, (int)m->nv);
  mjtNum* push = d->xfrc_applied + 6 * course->load_body;
  int64_t steps = course->nperiod * course->substeps, read = 0, whole = 0;
  for (int64_t i = 0; i < steps; i++) {
    set_inputs(d, course, i, m->opt.timestep, push);
    bool is_read = read < course->nread && course->rows[read] == i;
    // The first step leaves what never changes in mjData, the last all that belongs to its instant.
    bool is_end = i == 0 || i == steps - 1;
    if (!self->is_known || is_read || is_end || !step(self, &plain, d, push)) {
      mj_step(is_read ? m : &blind, d);
      whole++;
      if (self->is_known && !is_saturated(m, d)) {
        keep_slopes(self, m, d);
      }
    }
    if (is_read) {
      mju_copy(course->sensors + read * m->nsensordata, d->sensordata, (int)m->nsensordata);
      mju_copy(course->velocities + read * m->nv, d->qvel, (int)m->nv);
      read++;
    }
  }
  return whole;
}
