// Vectors of three and matrices of nine numbers, without a call into another library for each.

#ifndef BENCH_VECTOR_H_
#define BENCH_VECTOR_H_

#include <mujoco/mujoco.h>

static inline mjtNum dot(const mjtNum* a, const mjtNum* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void copy(mjtNum* restrict result, const mjtNum* restrict a, int count) {
  for (int k = 0; k < count; k++) {
    result[k] = a[k];
  }
}

static inline void zero(mjtNum* result, int count) {
  for (int k = 0; k < count; k++) {
    result[k] = 0;
  }
}

// result += scale * a
static inline void add_scaled(mjtNum* restrict result, const mjtNum* restrict a, mjtNum scale) {
  result[0] += scale * a[0];
  result[1] += scale * a[1];
  result[2] += scale * a[2];
}

static inline void cross(mjtNum* restrict result, const mjtNum* a, const mjtNum* b) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

// result += a x b
static inline void add_cross(mjtNum* restrict result, const mjtNum* a, const mjtNum* b) {
  result[0] += a[1] * b[2] - a[2] * b[1];
  result[1] += a[2] * b[0] - a[0] * b[2];
  result[2] += a[0] * b[1] - a[1] * b[0];
}

static inline void apply(mjtNum* restrict result, const mjtNum* matrix, const mjtNum* vector) {
  result[0] = dot(matrix, vector);
  result[1] = dot(matrix + 3, vector);
  result[2] = dot(matrix + 6, vector);
}

static inline void compose(mjtNum* restrict result, const mjtNum* restrict a, const mjtNum* restrict b) {
  for (int i = 0; i < 9; i += 3) {
    for (int j = 0; j < 3; j++) {
      result[i + j] = a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
    }
  }
}

#endif  // BENCH_VECTOR_H_
