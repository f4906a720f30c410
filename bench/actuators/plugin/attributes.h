// Attributes of a plugin instance, read from the <config> elements of the model and checked.

#ifndef BENCH_ATTRIBUTES_H_
#define BENCH_ATTRIBUTES_H_

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include <mujoco/mujoco.h>

// Which numbers an attribute may take.
typedef enum Range {
  ANY,              // any finite number
  NONNEGATIVE,      // >= 0
  POSITIVE,         // > 0
  FRACTION,         // 0 <= value < 1
  SIGNED_FRACTION,  // -1 < value < 1
  AT_LEAST_ONE,     // >= 1
} Range;

// Default of an attribute that has to be given, and of one that only some settings of the others need.
#define REQUIRED INFINITY
#define UNSET NAN

// One numeric attribute: where it goes in the parameters of its law.
typedef struct Number {
  const char* name;
  size_t offset;  // of a double
  double fallback;
  Range range;
} Number;

// Reads the attributes of one actuator. Its instance may have several: each number then is one for all of them, or one
// for each in their order in the model. `ok` turns false at the first fault, which is reported as a warning. Blanks alone
// count as an attribute that was not given: a model may keep room for one.
typedef struct Reader {
  const mjModel* m;
  int instance;
  int actuator;
  int index;  // of the actuator among those of its instance
  int count;  // of the actuators of its instance
  bool ok;
  bool silent;  // reports nothing
} Reader;

// Reports a fault of the actuator.
void fault(Reader* reader, const char* sentence);

// Reports a fault of the attribute `name`; `rule` ends the sentence "attribute <name> = '<value>' ...".
void attribute_fault(Reader* reader, const char* name, const char* rule);

// Reads the attributes of a table into the struct at `parameters`.
void read_numbers(Reader* reader, const Number* numbers, int count, void* parameters);

// Faults unless `name` was given; `reason` says what makes it necessary.
void need(Reader* reader, const char* name, const char* reason);

// Reads numbers separated by blanks, all for one actuator. Returns an array from mju_malloc, or NULL after a fault.
double* read_list(Reader* reader, const char* name, int* count);

// Returns the id of the tendon that the attribute names, or -1 when it is not given or after a fault.
int read_tendon(Reader* reader, const char* name);

#endif  // BENCH_ATTRIBUTES_H_
