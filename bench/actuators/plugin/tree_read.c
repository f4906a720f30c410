#include <math.h>
#include <string.h>

#include "tree.h"
#include "vector.h"

// A centre of mass nearer to the axis than this lies on it [m].
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
  if (link->mass > 0) {  // what has an inertia alone may be anywhere
    mju_scl3(link->com, first, 1 / link->mass);
  }
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
