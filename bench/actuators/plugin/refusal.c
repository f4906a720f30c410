// Whether a model whose plugin attributes were written over would still be accepted: what compiling it would find out.

#include <string.h>

#include "instance.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static const Law* law_of(const mjModel* m, int instance) {
  const Law* laws[] = {&friction_law, &gas_spring_law, &torque_table_law};
  const char* name = mjp_getPluginAtSlot(m->plugin[instance])->name;
  for (int i = 0; i < 3; i++) {
    if (strcmp(laws[i]->name, name) == 0) {
      return laws[i];
    }
  }
  return NULL;
}

// Finds the place of an actuator among those that share its instance, and how many they are.
static void count_sharing(const mjModel* m, Reader* reader) {
  for (int i = 0; i < m->nactuator; i++) {
    if (m->actuator_plugin[i] == reader->instance) {
      reader->index += i < reader->actuator;
      reader->count++;
    }
  }
}

EXPORT int bench_refuses(const mjModel* m);

// Returns 1 when the law of an actuator refuses the attributes in the model, 0 when all are accepted.
int bench_refuses(const mjModel* m) {
  for (int actuator = 0; actuator < m->nactuator; actuator++) {
    int instance = m->actuator_plugin[actuator];
    const Law* law = instance < 0 ? NULL : law_of(m, instance);
    if (!law) {
      continue;
    }
    Reader reader = {.m = m, .instance = instance, .actuator = actuator, .ok = true, .silent = true};
    count_sharing(m, &reader);
    Element* element = mju_malloc(law->size);
    memset(element, 0, law->size);
    element->actuator = actuator;
    element->output = m->actuator_outadr[actuator];
    read_numbers(&reader, law->numbers, law->nnumber, element);
    law->read(element, &reader);
    if (law->clear) {
      law->clear(element);
    }
    mju_free(element);
    if (!reader.ok) {
      return 1;
    }
  }
  return 0;
}
