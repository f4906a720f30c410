// Joint-space inertia and bias forces of a tree of hinges and slides, without what a step does not need: bodies that hang
// together rigidly are one, and rotors about fixed axes are numbers.

#ifndef BENCH_TREE_H_
#define BENCH_TREE_H_

#include <stdbool.h>

#include <mujoco/mujoco.h>

enum { MAX_LINKS = 32, MAX_BODIES = 128 };

// Angular and linear part, about the origin of the world.
typedef struct Spatial {
  mjtNum angular[3];
  mjtNum linear[3];
} Spatial;

// What moves with one joint. Its frame has the axis of the joint as z and its origin on it; with several joints on a
// body all but the last are empty.
typedef struct Link {
  int dof, qpos, parent;  // parent: link, -1: the world
  bool is_slide;
  mjtNum zero;        // qpos at which the model was described
  mjtNum anchor[3];   // of the frame in that of the parent
  mjtNum turn[9];     // rotation of the frame against that of the parent, at zero
  mjtNum mass;        // [kg]
  mjtNum com[3];      // centre of mass in the frame [m]
  mjtNum inertia[9];  // about the centre of mass, in the frame [kg m^2]
} Link;

// A joint about a fixed axis through the centre of mass of all that it moves: its inertia is constant, it has no weight.
typedef struct Rotor {
  int dof;
  mjtNum inertia;  // with armature
} Rotor;

// Mass, first and second moments about the origin of the world; second: xx xy xz yy yz zz.
typedef struct Moments {
  mjtNum mass, first[3], second[6];
} Moments;

typedef struct Tree {
  int nlink, nrotor;
  Link link[MAX_LINKS];
  Rotor rotor[MAX_LINKS];
  mjtNum armature[MAX_LINKS];
  // Of the present instant
  mjtNum rotation[MAX_LINKS][9];  // of the frame in the world
  mjtNum origin[MAX_LINKS][3];
  Spatial axis[MAX_LINKS];  // velocity of what moves with a link, for a joint velocity of one
  Moments moments[MAX_LINKS];
  mjtNum M[MAX_LINKS][MAX_LINKS];  // lower triangle; zero between branches
  mjtNum bias[MAX_LINKS];
} Tree;

// A point of the model, in the frame of the link with which it moves; link -1: of the world.
typedef struct Point {
  int link;
  mjtNum local[3];
} Point;

// Describes a model. Returns false where it has other joints, or too many.
bool tree_read(Tree* tree, const mjModel* m, Point* body_com, int body, Point* sites, const int* site_ids, int nsite);

// Takes over positions and velocities; accelerations and what acts at a point, unless NULL, are part of the bias.
void tree_bias(Tree* tree, const mjModel* m, const mjData* d, const mjtNum* qacc, const Point* at, const mjtNum* push);

// The joint-space inertia at the positions that `tree_bias` took over.
void tree_inertia(Tree* tree);

// World coordinates of a point.
void tree_point(const Tree* tree, const Point* point, mjtNum result[3]);

// Adds sign * derivative of (direction . point) with respect to every joint of the tree, row[dof].
void tree_jacobian(const Tree* tree, const Point* point, const mjtNum place[3], const mjtNum direction[3], mjtNum sign,
                   mjtNum* row);

#endif  // BENCH_TREE_H_
