#include "tree.h"

#include <math.h>
#include <string.h>

#include "vector.h"

void tree_point(const Tree* tree, const Point* point, mjtNum result[3]) {
  if (point->link < 0) {
    copy(result, point->local, 3);
    return;
  }
  apply(result, tree->rotation[point->link], point->local);
  add_scaled(result, tree->origin[point->link], 1);
}

void tree_jacobian(const Tree* tree, const Point* point, const mjtNum place[3], const mjtNum direction[3], mjtNum sign,
                   mjtNum* row) {
  mjtNum moment[3];
  cross(moment, place, direction);
  for (int i = point->link; i >= 0; i = tree->link[i].parent) {
    const Spatial* axis = tree->axis + i;
    row[tree->link[i].dof] += sign * (dot(axis->angular, moment) + dot(axis->linear, direction));
  }
}

static void times(Spatial* result, const Moments* I, const Spatial* v) {
  const mjtNum *w = v->angular, *s = I->second;
  result->angular[0] = s[0] * w[0] + s[1] * w[1] + s[2] * w[2];
  result->angular[1] = s[1] * w[0] + s[3] * w[1] + s[4] * w[2];
  result->angular[2] = s[2] * w[0] + s[4] * w[1] + s[5] * w[2];
  add_cross(result->angular, I->first, v->linear);
  for (int k = 0; k < 3; k++) {
    result->linear[k] = I->mass * v->linear[k];
  }
  add_cross(result->linear, w, I->first);
}

static void place_link(Tree* tree, int i, mjtNum q) {
  const Link* link = tree->link + i;
  mjtNum* R = tree->rotation[i];
  mjtNum* p = tree->origin[i];
  Spatial* axis = tree->axis + i;
  if (link->parent < 0) {
    copy(p, link->anchor, 3);
    copy(R, link->turn, 9);
  } else {
    const mjtNum* base = tree->rotation[link->parent];
    apply(p, base, link->anchor);
    add_scaled(p, tree->origin[link->parent], 1);
    compose(R, base, link->turn);
  }
  mjtNum z[3] = {R[2], R[5], R[8]};
  if (link->is_slide) {
    add_scaled(p, z, q - link->zero);
    zero(axis->angular, 3);
    copy(axis->linear, z, 3);
    return;
  }
  mjtNum c = cos(q - link->zero), s = sin(q - link->zero);
  for (int k = 0; k < 9; k += 3) {
    mjtNum x = R[k], y = R[k + 1];
    R[k] = c * x + s * y;
    R[k + 1] = c * y - s * x;
  }
  copy(axis->angular, z, 3);
  cross(axis->linear, p, z);
}

static void moments_of(Moments* result, const Tree* tree, int i) {
  const Link* link = tree->link + i;
  const mjtNum* R = tree->rotation[i];
  mjtNum c[3], part[9];
  apply(c, R, link->com);
  add_scaled(c, tree->origin[i], 1);
  compose(part, R, link->inertia);
  mjtNum m = link->mass;
  result->mass = m;
  zero(result->first, 3);
  add_scaled(result->first, c, m);
  mjtNum* s = result->second;
  s[0] = dot(part, R) + m * (c[1] * c[1] + c[2] * c[2]);
  s[1] = dot(part, R + 3) - m * c[0] * c[1];
  s[2] = dot(part, R + 6) - m * c[0] * c[2];
  s[3] = dot(part + 3, R + 3) + m * (c[0] * c[0] + c[2] * c[2]);
  s[4] = dot(part + 3, R + 6) - m * c[1] * c[2];
  s[5] = dot(part + 6, R + 6) + m * (c[0] * c[0] + c[1] * c[1]);
}

static mjtNum along(const Spatial* motion, const Spatial* force) {
  return dot(motion->angular, force->angular) + dot(motion->linear, force->linear);
}

static void add(Spatial* result, const Spatial* other) {
  for (int k = 0; k < 3; k++) {
    result->angular[k] += other->angular[k];
    result->linear[k] += other->linear[k];
  }
}

// Force that gives a link its acceleration while it moves: I a + v x* (I v).
static void inertial_force(Spatial* force, const Moments* I, const Spatial* v, const Spatial* a) {
  Spatial momentum;
  times(force, I, a);
  times(&momentum, I, v);
  add_cross(force->angular, v->angular, momentum.angular);
  add_cross(force->angular, v->linear, momentum.linear);
  add_cross(force->linear, v->angular, momentum.linear);
}

void tree_bias(Tree* tree, const mjModel* m, const mjData* d, const mjtNum* qacc, const Point* at, const mjtNum* push) {
  Spatial velocity[MAX_LINKS], acceleration[MAX_LINKS], force[MAX_LINKS];
  int n = tree->nlink;
  for (int i = 0; i < n; i++) {
    const Link* link = tree->link + i;
    const Spatial* axis = tree->axis + i;
    Spatial *v = velocity + i, *a = acceleration + i;
    mjtNum rate = d->qvel[link->dof];
    place_link(tree, i, d->qpos[link->qpos]);
    moments_of(tree->moments + i, tree, i);
    Spatial own;
    for (int k = 0; k < 3; k++) {
      own.angular[k] = axis->angular[k] * rate;
      own.linear[k] = axis->linear[k] * rate;
    }
    if (link->parent < 0) {
      *v = own;
      zero(a->angular, 3);
      zero(a->linear, 3);
      add_scaled(a->linear, m->opt.gravity, -1);
    } else {
      *v = velocity[link->parent];
      *a = acceleration[link->parent];
      add_cross(a->angular, v->angular, own.angular);
      add_cross(a->linear, v->angular, own.linear);
      add_cross(a->linear, v->linear, own.angular);
      add(v, &own);
    }
    if (qacc) {
      add_scaled(a->angular, axis->angular, qacc[link->dof]);
      add_scaled(a->linear, axis->linear, qacc[link->dof]);
    }
    inertial_force(force + i, tree->moments + i, v, a);
  }
  if (push && at->link >= 0) {
    mjtNum place[3];
    tree_point(tree, at, place);
    add_scaled(force[at->link].linear, push, -1);
    add_scaled(force[at->link].angular, push + 3, -1);
    add_cross(force[at->link].angular, push, place);
  }
  for (int i = n - 1; i >= 0; i--) {
    int parent = tree->link[i].parent;
    tree->bias[i] = along(tree->axis + i, force + i);
    if (parent >= 0) {
      add(force + parent, force + i);
    }
  }
}

void tree_inertia(Tree* tree) {
  Moments I[MAX_LINKS];
  int n = tree->nlink;
  memcpy(I, tree->moments, (size_t)n * sizeof(Moments));
  for (int i = n - 1; i >= 0; i--) {
    int parent = tree->link[i].parent;
    Spatial pull;
    times(&pull, I + i, tree->axis + i);
    tree->M[i][i] = along(tree->axis + i, &pull) + tree->armature[i];
    for (int j = parent; j >= 0; j = tree->link[j].parent) {
      tree->M[i][j] = along(tree->axis + j, &pull);
    }
    if (parent >= 0) {
      I[parent].mass += I[i].mass;
      add_scaled(I[parent].first, I[i].first, 1);
      for (int k = 0; k < 6; k++) {
        I[parent].second[k] += I[i].second[k];
      }
    }
  }
}
