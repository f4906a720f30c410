#include "tree.h"

#include <math.h>
#include <string.h>

#include "vector.h"

// Masses below it on a rotor, out of its axis, count as none [m].
static const double kOnAxis = 1e-12;

// Adds the inertia of a point mass at `r` about the origin.
static void add_steiner(mjtNum* inertia, mjtNum mass, const mjtNum* r) {
  mjtNum square = dot(r, r);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      inertia[3 * i + j] += mass * ((i == j ? square : 0) - r[i] * r[j]);
    }
  }
}

// Where a body or a link stands when all joints are at their zero.
typedef struct Pose {
  mjtNum place[3];
  mjtNum rotation[9];
} Pose;

static void at_zero(Pose* pose, const Pose* parent, const mjtNum* place, const mjtNum* quat) {
  mjtNum turn[9], shift[3];
  mju_quat2Mat(turn, quat);
  compose(pose->rotation, parent->rotation, turn);
  apply(shift, parent->rotation, place);
  mju_add3(pose->place, parent->place, shift);
}

// Frame with a given axis as z.
static void frame_of(Pose* pose, const mjtNum* place, const mjtNum* axis) {
  mjtNum quat[4], unit[3] = {axis[0], axis[1], axis[2]};
  mju_normalize3(unit);
  mju_copy3(pose->place, place);
  mju_quatZ2Vec(quat, unit);
  mju_quat2Mat(pose->rotation, quat);
}

static void express(Point* point, int link, const Pose* frames, const mjtNum* place) {
  point->link = link;
  mju_copy3(point->local, place);
  if (link >= 0) {
    mjtNum shift[3];
    mju_sub3(shift, place, frames[link].place);
    mju_mulMatTVec3(point->local, frames[link].rotation, shift);
  }
}

// Adds a rigid body to a link; inertia is about the centre of mass of the body, in world axes, all at zero.
static void add_body(Link* link, const Pose* frame, mjtNum mass, const mjtNum* place, const mjtNum* inertia) {
  mjtNum shift[3], local[3], turned[9], back[9], first[3], sum[9];
  if (mass == 0) {
    return;
  }
  mju_sub3(shift, place, frame->place);
  mju_mulMatTVec3(local, frame->rotation, shift);
  mju_mulMatTMat(back, frame->rotation, inertia, 3, 3, 3);
  compose(turned, back, frame->rotation);
  mju_scl3(first, link->com, link->mass);
  mju_addToScl3(first, local, mass);
  mju_add(sum, link->inertia, turned, 9);
  add_steiner(sum, link->mass, link->com);
  add_steiner(sum, mass, local);
  link->mass += mass;
  mju_scl3(link->com, first, 1 / link->mass);
  add_steiner(sum, -link->mass, link->com);
  mju_copy(link->inertia, sum, 9);
}

// Takes links that are rotors out; `moved[i]` is where link i went, or -1.
static bool part_rotors(Tree* tree, int* moved) {
  int kept = 0;
  for (int i = 0; i < tree->nlink; i++) {
    Link* link = tree->link + i;
    bool is_leaf = true;
    for (int j = i + 1; j < tree->nlink; j++) {
      is_leaf = is_leaf && tree->link[j].parent != i;
    }
    bool is_rotor = is_leaf && link->parent < 0 && !link->is_slide &&
                    (link->mass == 0 || hypot(link->com[0], link->com[1]) < kOnAxis);
    if (is_rotor) {
      tree->rotor[tree->nrotor++] = (Rotor){link->dof, link->inertia[8] + tree->armature[i]};
      moved[i] = -1;
    } else {
      moved[i] = kept;
      tree->armature[kept] = tree->armature[i];
      tree->link[kept] = *link;
      tree->link[kept].parent = link->parent < 0 ? -1 : moved[link->parent];
      kept++;
    }
  }
  tree->nlink = kept;
  return kept > 0;
}

static const Pose kWorld = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

bool tree_read(Tree* tree, const mjModel* m, Point* body_com, int body, Point* sites, const int* site_ids, int nsite) {
  memset(tree, 0, sizeof(*tree));
  if (m->nv > MAX_LINKS || m->nbody > MAX_BODIES) {
    return false;
  }
  Pose bodies[MAX_BODIES], frames[MAX_LINKS];
  int last[MAX_BODIES];  // link with which a body moves, -1: none
  bodies[0] = kWorld;
  last[0] = -1;
  for (int b = 1; b < m->nbody; b++) {
    int up = m->body_parentid[b];
    Pose* pose = bodies + b;
    at_zero(pose, bodies + up, m->body_pos + 3 * b, m->body_quat + 4 * b);
    last[b] = last[up];
    for (int j = m->body_jntadr[b]; j >= 0 && j < m->body_jntadr[b] + m->body_jntnum[b]; j++) {
      if (m->jnt_type[j] != mjJNT_HINGE && m->jnt_type[j] != mjJNT_SLIDE) {
        return false;
      }
      int i = tree->nlink++;
      Link* link = tree->link + i;
      mjtNum place[3], axis[3];
      apply(place, pose->rotation, m->jnt_pos + 3 * j);
      mju_addTo3(place, pose->place);
      apply(axis, pose->rotation, m->jnt_axis + 3 * j);
      frame_of(frames + i, place, axis);
      const Pose* base = last[b] < 0 ? &kWorld : frames + last[b];
      *link = (Link){.dof = m->jnt_dofadr[j], .qpos = m->jnt_qposadr[j], .parent = last[b],
                     .is_slide = m->jnt_type[j] == mjJNT_SLIDE, .zero = m->qpos0[m->jnt_qposadr[j]]};
      Point anchor;
      express(&anchor, last[b], frames, place);
      mju_copy3(link->anchor, anchor.local);
      mju_mulMatTMat(link->turn, base->rotation, frames[i].rotation, 3, 3, 3);
      tree->armature[i] = m->dof_armature[link->dof];
      last[b] = i;
    }
    if (last[b] >= 0) {
      Pose principal;
      mjtNum diagonal[9] = {0}, part[9], inertia[9];
      at_zero(&principal, pose, m->body_ipos + 3 * b, m->body_iquat + 4 * b);
      for (int k = 0; k < 3; k++) {
        diagonal[4 * k] = m->body_inertia[3 * b + k];
      }
      compose(part, principal.rotation, diagonal);
      mju_mulMatMatT(inertia, part, principal.rotation, 3, 3, 3);
      add_body(tree->link + last[b], frames + last[b], m->body_mass[b], principal.place, inertia);
    }
  }
  mjtNum place[3];
  apply(place, bodies[body].rotation, m->body_ipos + 3 * body);
  mju_addTo3(place, bodies[body].place);
  express(body_com, last[body], frames, place);
  for (int s = 0; s < nsite; s++) {
    int owner = m->site_bodyid[site_ids[s]];
    apply(place, bodies[owner].rotation, m->site_pos + 3 * site_ids[s]);
    mju_addTo3(place, bodies[owner].place);
    express(sites + s, last[owner], frames, place);
  }
  int moved[MAX_LINKS];
  bool ok = part_rotors(tree, moved);
  for (int s = -1; s < nsite; s++) {
    Point* point = s < 0 ? body_com : sites + s;
    if (point->link >= 0) {
      point->link = moved[point->link];
      ok = ok && point->link >= 0;
    }
  }
  return ok;
}

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

// Mass, first and second moments about the origin of the world; second: xx xy xz yy yz zz.
typedef struct Moments {
  mjtNum mass, first[3], second[6];
} Moments;

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
  if (link->mass == 0) {
    memset(result, 0, sizeof(*result));
    return;
  }
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

void tree_update(Tree* tree, const mjModel* m, const mjData* d, const Point* at, const mjtNum* push) {
  Moments I[MAX_LINKS];
  Spatial velocity[MAX_LINKS], acceleration[MAX_LINKS], force[MAX_LINKS];
  int n = tree->nlink;
  for (int i = 0; i < n; i++) {
    const Link* link = tree->link + i;
    const Spatial* axis = tree->axis + i;
    Spatial *v = velocity + i, *a = acceleration + i;
    mjtNum rate = d->qvel[link->dof];
    place_link(tree, i, d->qpos[link->qpos]);
    moments_of(I + i, tree, i);
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
    inertial_force(force + i, I + i, v, a);
  }
  if (at->link >= 0) {
    mjtNum place[3];
    tree_point(tree, at, place);
    add_scaled(force[at->link].linear, push, -1);
    add_scaled(force[at->link].angular, push + 3, -1);
    add_cross(force[at->link].angular, push, place);
  }
  for (int i = n - 1; i >= 0; i--) {
    int parent = tree->link[i].parent;
    tree->bias[i] = along(tree->axis + i, force + i);
    Spatial pull;
    times(&pull, I + i, tree->axis + i);
    tree->M[i][i] = along(tree->axis + i, &pull) + tree->armature[i];
    for (int j = parent; j >= 0; j = tree->link[j].parent) {
      tree->M[i][j] = along(tree->axis + j, &pull);
    }
    if (parent >= 0) {
      add(force + parent, force + i);
      I[parent].mass += I[i].mass;
      add_scaled(I[parent].first, I[i].first, 1);
      for (int k = 0; k < 6; k++) {
        I[parent].second[k] += I[i].second[k];
      }
    }
  }
}
