#include "forces.h"

#include <math.h>
#include <string.h>

#include "vector.h"

static bool any(const mjtNum* values, mjtSize count) {
  for (mjtSize i = 0; i < count; i++) {
    if (values[i] != 0) {
      return true;
    }
  }
  return false;
}

static bool read_servo(Forces* self, const mjModel* m, int i) {
  bool is_pid = m->actuator_gaintype[i] == mjGAIN_PID;
  bool has_integral = m->actuator_dyntype[i] == mjDYN_PID;
  int inputs = is_pid ? 2 : 1;
  bool known = (is_pid || m->actuator_gaintype[i] == mjGAIN_FIXED) &&
               (m->actuator_biastype[i] == mjBIAS_NONE || m->actuator_biastype[i] == mjBIAS_AFFINE) &&
               (m->actuator_dyntype[i] == mjDYN_NONE || (is_pid && has_integral)) &&
               m->actuator_actnum[i] == (has_integral ? 1 : 0) && m->actuator_ctrlnum[i] == inputs &&
               (!is_pid || m->actuator_ctrlspec[i] == (mjINPUT_POS | mjINPUT_VEL)) && !m->actuator_actearly[i] &&
               !m->actuator_actlimited[i] && self->nservo < MAX_SERVOS;
  if (!known) {
    return false;
  }
  self->servo[self->nservo++] = (Servo){
      .actuator = i,
      .output = m->actuator_outadr[i],
      .control = m->actuator_ctrladr[i],
      .integral = has_integral ? m->actuator_actadr[i] : -1,
      .is_pid = is_pid,
      .most = has_integral && m->actuator_dynprm[mjNDYN * i] > 0 ? m->actuator_dynprm[mjNDYN * i] : mjMAXVAL,
  };
  return !has_integral || m->actuator_dynprm[mjNDYN * i + 1] == 0;  // no slew
}

// Whether nothing can touch, rub, be tied, be delayed, float or sleep.
static bool is_free(const mjModel* m) {
  bool odd = m->nq != m->nv || m->njnt != m->nv || m->neq || m->npair || m->nmocap || m->nflex || m->nhistory ||
             m->ngravcomp || m->opt.density != 0 || m->opt.viscosity != 0 || m->opt.disableflags || m->opt.enableflags;
  for (int i = 0; i < m->ngeom; i++) {
    odd = odd || m->geom_contype[i] || m->geom_conaffinity[i];
  }
  for (int i = 0; i < m->njnt; i++) {
    odd = odd || m->dof_frictionloss[i] != 0;
  }
  for (int i = 0; i < m->ntendon; i++) {
    odd = odd || m->tendon_limited[i] || m->tendon_actfrclimited[i] || m->tendon_frictionloss[i] != 0 ||
          m->tendon_armature[i] != 0;
  }
  return !odd;
}

bool forces_read(Forces* self, const mjModel* m) {
  memset(self, 0, sizeof(*self));
  bool odd = !is_free(m) || m->nplugin > MAX_PLUGINS || any(m->dof_dampingpoly, mjNPOLY * m->nv) ||
             any(m->tendon_dampingpoly, mjNPOLY * m->ntendon) || any(m->actuator_armature, m->nactuator) ||
             any(m->actuator_damping, m->nactuator) || any(m->actuator_dampingpoly, mjNPOLY * m->nactuator);
  for (int i = 0; i < m->nactuator && !odd; i++) {
    int kind = m->actuator_trntype[i], tendon = m->actuator_trnid[2 * i];
    bool on_joint = kind == mjTRN_JOINT, on_tendon = kind == mjTRN_TENDON;
    if (m->actuator_plugin[i] < 0) {
      // A servo on a tendon whose Jacobian changes would have another derivative in each pose.
      bool is_fixed = on_joint || (on_tendon && m->wrap_type[m->tendon_adr[tendon]] == mjWRAP_JOINT);
      odd = !is_fixed || !read_servo(self, m, i);
    } else {
      odd = !(on_joint || on_tendon) || m->actuator_actnum[i] || m->actuator_gaintype[i] != mjGAIN_FIXED ||
            m->actuator_biastype[i] != mjBIAS_NONE;
    }
  }
  for (int i = 0; i < m->nplugin && !odd; i++) {
    const mjpPlugin* plugin = mjp_getPluginAtSlot(m->plugin[i]);
    odd = plugin->capabilityflags != mjPLUGIN_ACTUATOR;
    self->instance[i] = i;
    self->compute[i] = plugin->compute;
    self->advance[i] = plugin->advance;
  }
  self->nplugin = odd ? 0 : (int)m->nplugin;
  for (int i = 0; i < m->njnt; i++) {
    self->has_limits = self->has_limits || m->jnt_actfrclimited[i];
  }
  self->is_plain = !m->nplastic && !any(m->jnt_stiffnesspoly, mjNPOLY * m->njnt) &&
                   !any(m->tendon_stiffnesspoly, mjNPOLY * m->ntendon);
  for (int i = 0; i < m->ntendon && !odd; i++) {
    const int* wrap = m->wrap_type + m->tendon_adr[i];
    if (wrap[0] != mjWRAP_JOINT) {
      odd = m->tendon_num[i] != 2 || wrap[0] != mjWRAP_SITE || wrap[1] != mjWRAP_SITE || m->tendon_damping[i] != 0 ||
            self->nstraight == MAX_STRAIGHT;
      self->straight[odd ? 0 : self->nstraight++].tendon = i;
    }
  }
  return !odd;
}

void forces_ends(const Forces* self, const mjModel* m, int* sites) {
  for (int i = 0; i < self->nstraight; i++) {
    memcpy(sites + 2 * i, m->wrap_objid + m->tendon_adr[self->straight[i].tendon], 2 * sizeof(int));
  }
}

void forces_join(Forces* self, const Point* ends) {
  for (int i = 0; i < self->nstraight; i++) {
    self->straight[i].from = ends[2 * i];
    self->straight[i].to = ends[2 * i + 1];
  }
}

// Lengths and Jacobians of the straight tendons, and of what pulls along them.
static void update_straight(const Forces* self, const Tree* tree, const mjModel* m, mjData* d) {
  for (int i = 0; i < self->nstraight; i++) {
    const Straight* one = self->straight + i;
    int tendon = one->tendon;
    mjtNum from[3], to[3], direction[3], row[MAX_LINKS];
    tree_point(tree, &one->from, from);
    tree_point(tree, &one->to, to);
    for (int k = 0; k < 3; k++) {
      direction[k] = to[k] - from[k];
    }
    d->ten_length[tendon] = mju_normalize3(direction);
    zero(row, (int)m->nv);
    tree_jacobian(tree, &one->to, to, direction, 1, row);
    tree_jacobian(tree, &one->from, from, direction, -1, row);
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

static mjtNum along_row(const mjtNum* values, const int* columns, int count, const mjtNum* vector) {
  mjtNum sum = 0;
  for (int k = 0; k < count; k++) {
    sum += values[k] * vector[columns[k]];
  }
  return sum;
}

static void add_row(mjtNum* vector, const mjtNum* values, const int* columns, int count, mjtNum scale) {
  for (int k = 0; k < count; k++) {
    vector[columns[k]] += scale * values[k];
  }
}

static void update_tendons(const mjModel* m, mjData* d) {
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
}

static void update_actuator(const mjModel* m, mjData* d, int i) {
  int out = m->actuator_outadr[i], id = m->actuator_trnid[2 * i], row = d->moment_rowadr[out];
  mjtNum length = m->actuator_trntype[i] == mjTRN_JOINT ? d->qpos[m->jnt_qposadr[id]] : d->ten_length[id];
  d->actuator_length[out] = m->actuator_gear[6 * out] * length;
  d->actuator_velocity[out] =
      along_row(d->actuator_moment + row, d->moment_colind + row, d->moment_rownnz[out], d->qvel);
}

static void add_springs(const mjModel* m, const mjData* d, mjtNum* force) {
  for (int i = 0; i < m->njnt; i++) {
    mjtNum stretch = d->qpos[m->jnt_qposadr[i]] - m->qpos_spring[m->jnt_qposadr[i]];
    int dof = m->jnt_dofadr[i];
    force[dof] -= m->jnt_stiffness[i] * stretch + m->dof_damping[dof] * d->qvel[dof];
  }
  for (int i = 0; i < m->ntendon; i++) {
    const mjtNum* rest = m->tendon_lengthspring + 2 * i;
    mjtNum length = d->ten_length[i];
    mjtNum stretch = length > rest[1] ? length - rest[1] : length < rest[0] ? length - rest[0] : 0;
    mjtNum pull = m->tendon_stiffness[i] * stretch + m->tendon_damping[i] * d->ten_velocity[i];
    int row = m->ten_J_rowadr[i];
    if (pull != 0) {
      add_row(force, d->ten_J + row, m->ten_J_colind + row, m->ten_J_rownnz[i], -pull);
    }
  }
}

static bool is_inside(const mjtNum* range, mjtNum value) {
  return value > range[0] && value < range[1];
}

// Sets force and derivative of the integral. Returns false where an input or the integral reaches its bound.
static bool update_servo(const Servo* one, const mjModel* m, mjData* d) {
  const mjtNum* bias = m->actuator_biasprm + mjNBIAS * one->actuator;
  const mjtNum* input = d->ctrl + one->control;
  mjtNum gain = m->actuator_gainprm[mjNGAIN * one->actuator];
  mjtNum length = d->actuator_length[one->output], velocity = d->actuator_velocity[one->output];
  for (int k = 0; k < (one->is_pid ? 2 : 1); k++) {
    if (m->actuator_ctrllimited[one->control + k] &&
        !is_inside(m->actuator_ctrlrange + 2 * (one->control + k), input[k])) {
      return false;
    }
  }
  mjtNum force = m->actuator_biastype[one->actuator] == mjBIAS_NONE
                     ? 0 : bias[0] + bias[1] * length + bias[2] * velocity;
  if (!one->is_pid) {
    force += gain * input[0];
  } else {
    force -= bias[1] * input[0] + bias[2] * input[1];
    if (one->integral >= 0) {
      mjtNum integral = d->act[one->integral], rate = input[0] - length;
      d->act_dot[one->integral] = rate;
      force += gain * integral;
      if (!(fabs(integral) + fabs(rate) * m->opt.timestep < one->most)) {
        return false;
      }
    }
  }
  d->actuator_force[one->output] = force;
  return true;
}

// Lengths and velocities of tendons and actuators, and the forces of springs and dampers, shape nv.
static void update_springs(const Forces* self, const Tree* tree, const mjModel* m, mjData* d, mjtNum* force) {
  update_straight(self, tree, m, d);
  update_tendons(m, d);
  for (int i = 0; i < m->nactuator; i++) {
    update_actuator(m, d, i);
  }
  if (self->is_plain) {
    zero(force, (int)m->nv);
    add_springs(m, d, force);
  } else {
    mj_passive(m, d);
    if (force != d->qfrc_passive) {
      copy(force, d->qfrc_passive, (int)m->nv);
    }
  }
}

static void update_plugins(const Forces* self, const mjModel* m, mjData* d) {
  for (int i = 0; i < self->nplugin; i++) {
    self->compute[i](m, d, self->instance[i], mjPLUGIN_ACTUATOR);
  }
}

static void add_actuator(mjtNum* force, const mjModel* m, const mjData* d, int i) {
  int out = m->actuator_outadr[i], row = d->moment_rowadr[out];
  add_row(force, d->actuator_moment + row, d->moment_colind + row, d->moment_rownnz[out], d->actuator_force[out]);
}

// Whether all that actuators do on joints with a limit (`actuatorfrcrange`) is within it.
static bool are_within(const mjModel* m, const mjtNum* acted) {
  for (int i = 0; i < m->njnt; i++) {
    if (m->jnt_actfrclimited[i] && !is_inside(m->jnt_actfrcrange + 2 * i, acted[m->jnt_dofadr[i]])) {
      return false;
    }
  }
  return true;
}

// Cuts what actuators do off at the limits of their joints.
static void cut_off(const mjModel* m, mjtNum* acted) {
  for (int i = 0; i < m->njnt; i++) {
    if (m->jnt_actfrclimited[i]) {
      const mjtNum* range = m->jnt_actfrcrange + 2 * i;
      mjtNum* one = acted + m->jnt_dofadr[i];
      *one = mju_clip(*one, range[0], range[1]);
    }
  }
}

bool forces_update(const Forces* self, const Tree* tree, const mjModel* m, mjData* d, mjtNum* force) {
  update_springs(self, tree, m, d, force);
  for (int i = 0; i < self->nservo; i++) {
    if (!update_servo(self->servo + i, m, d)) {
      return false;
    }
  }
  update_plugins(self, m, d);
  mjtNum apart[MAX_LINKS], *acted = force;
  if (self->has_limits) {
    zero(apart, (int)m->nv);
    acted = apart;
  }
  for (int i = 0; i < m->nactuator; i++) {
    if (m->actuator_forcelimited[i] &&
        !is_inside(m->actuator_forcerange + 2 * i, d->actuator_force[m->actuator_outadr[i]])) {
      return false;
    }
    add_actuator(acted, m, d, i);
  }
  if (self->has_limits) {
    if (!are_within(m, apart)) {
      return false;
    }
    for (int i = 0; i < m->nv; i++) {
      force[i] += apart[i];
    }
  }
  return true;
}

void forces_undriven(const Forces* self, const Tree* tree, const mjModel* m, mjData* d) {
  update_springs(self, tree, m, d, d->qfrc_passive);
  update_plugins(self, m, d);
  zero(d->qfrc_actuator, (int)m->nv);
  for (int i = 0; i < m->nactuator; i++) {
    if (m->actuator_plugin[i] >= 0) {
      add_actuator(d->qfrc_actuator, m, d, i);
    } else {
      d->actuator_force[m->actuator_outadr[i]] = 0;
    }
  }
  if (self->has_limits) {
    cut_off(m, d->qfrc_actuator);
  }
}

void forces_remember(const Forces* self, const mjModel* m, mjData* d) {
  for (int i = 0; i < self->nplugin; i++) {
    self->advance[i](m, d, self->instance[i]);
  }
}

void forces_advance(const Forces* self, const mjModel* m, mjData* d) {
  if (m->nplastic) {
    mj_Euler(m, d);
    return;
  }
  mjtNum h = m->opt.timestep;
  for (int i = 0; i < self->nservo; i++) {
    int integral = self->servo[i].integral;
    if (integral >= 0) {
      d->act[integral] += h * d->act_dot[integral];
    }
  }
  for (int i = 0; i < m->nv; i++) {
    d->qvel[i] += h * d->qacc[i];
    d->qpos[i] += h * d->qvel[i];
  }
  d->time += h;
  forces_remember(self, m, d);
}
