// Registers the plugins when the library is loaded.

#include "instance.h"

// MuJoCo does not tell these two callbacks which plugin they belong to, so each law has its own.
#define CALLBACKS(law)                                                \
  static int law##_init(const mjModel* m, mjData* d, int instance) {  \
    return init_instance(&law##_law, m, d, instance);                 \
  }                                                                   \
  static int law##_nstate(const mjModel* m, int instance) {           \
    return count_states(&law##_law, m, instance);                     \
  }

CALLBACKS(friction)
CALLBACKS(gas_spring)
CALLBACKS(torque_table)

mjPLUGIN_LIB_INIT(bench_actuators) {
  register_law(&friction_law, friction_init, friction_nstate);
  register_law(&gas_spring_law, gas_spring_init, gas_spring_nstate);
  register_law(&torque_table_law, torque_table_init, torque_table_nstate);
}
