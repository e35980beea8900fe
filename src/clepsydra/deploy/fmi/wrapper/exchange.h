/* Model exchange: derivatives and event indicators for an importer's integrator, and memories.

   Memories are discrete variables, which change in event mode only. Some of them, such as the
   stem of a valve with play, follow the motion at the end of every integrator step; what they
   would be is kept apart, and only where the results would be others with it the importer is
   asked for an event, in which the memories take what was kept. A stem that is pushed on and on
   needs no event; one that is left behind does. */
#ifndef EXCHANGE_H
#define EXCHANGE_H

static double *real_at(model_memory *memory, uint32_t reference)
{
  return (double *)(void *)((char *)memory + model_variables[reference].place);
}

static bool has_size(const instance *each, size_t size, size_t expected, const char *function)
{
  char text[160];
  if (size == expected) {
    return true;
  }
  (void)snprintf(text, sizeof text, "%s: the model has %lu of them, not %lu", function,
                 (unsigned long)expected, (unsigned long)size);
  return refuse(each, text);
}

static bool is_exchanged(const instance *each, const char *function)
{
  char text[160];
  if (MODEL_EXCHANGE) {
    return true;
  }
  (void)snprintf(text, sizeof text, "%s: this model is for co-simulation", function);
  return refuse(each, text);
}

static bool set_time(instance *each, double time)
{
  if (!is_exchanged(each, "set time")) {
    return false;
  }
  if (each->now.phase != MOVING && each->now.phase != EVENTS) {
    return in_phase(each, MOVING, "set time");
  }
  if (!(fabs(time) <= DBL_MAX)) {
    return refuse(each, "set time: it is not a number");
  }
  each->now.time = time;
  return true;
}

static bool set_states(instance *each, const double states[], size_t size)
{
  size_t index;
  if (!is_exchanged(each, "set continuous states") ||
      !in_phase(each, MOVING, "set continuous states") ||
      !has_size(each, size, model_state_count, "set continuous states")) {
    return false;
  }
  for (index = 0; index < size; ++index) {
    *real_at(&each->now.memory, model_states[index]) = states[index];
  }
  each->now.stale = true;
  return true;
}

/* Copies the states, their derivatives or the event indicators. */
static bool get_reals(instance *each, const uint32_t references[], size_t expected,
                      double values[], size_t size, const char *function)
{
  size_t index;
  if (!is_exchanged(each, function) || !has_size(each, size, expected, function)) {
    return false;
  }
  refresh(each);
  for (index = 0; index < size; ++index) {
    values[index] = *real_at(&each->now.memory, references[index]);
  }
  return true;
}

static bool get_nominals(instance *each, double values[], size_t size)
{
  size_t index;
  if (!is_exchanged(each, "get nominals") ||
      !has_size(each, size, model_state_count, "get nominals")) {
    return false;
  }
  for (index = 0; index < size; ++index) {
    values[index] = model_nominals[index];
  }
  return true;
}

static bool any_event(instance *each)
{
  size_t index;
  refresh(each);
  for (index = 0; index < model_indicator_count; ++index) {
    if (*real_at(&each->now.memory, model_indicators[index]) >= 0.0) {
      return true;
    }
  }
  return false;
}

static void keep_memories(instance *each)
{
  size_t index;
  for (index = 0; index < model_memory_count; ++index) {
    each->now.kept[index] = *real_at(&each->now.memory, model_memories[index]);
  }
}

static void take_memories(instance *each)
{
  size_t index;
  for (index = 0; index < model_memory_count; ++index) {
    *real_at(&each->now.memory, model_memories[index]) = each->now.kept[index];
  }
  each->now.stale = true;
}

/* Keeps what a step leaves behind; says whether the results would be others with it. */
static bool follow_motion(instance *each)
{
  model_memory ahead = each->now.memory;
  size_t index;
  for (index = 0; index < model_memory_count; ++index) {
    *real_at(&ahead, model_memories[index]) = each->now.kept[index];
  }
  model_update(&ahead);
  for (index = 0; index < model_memory_count; ++index) {
    each->now.kept[index] = *real_at(&ahead, model_memories[index]);
  }
  model_show(&ahead);
  refresh(each);
  return memcmp(&ahead.outputs, &each->now.memory.outputs, sizeof ahead.outputs) != 0;
}

/* Carries out the events whose indicators are zero or positive; says whether more follow. */
static bool carry_out_events(instance *each, bool *more)
{
  *more = false;
  if (!is_exchanged(each, "update discrete states") ||
      !in_phase(each, EVENTS, "update discrete states")) {
    return false;
  }
  take_memories(each);
  if (any_event(each)) {
    model_switch(&each->now.memory);
    each->now.stale = true;
    keep_memories(each);
    *more = any_event(each);
  }
  return true;
}

/* Says whether what the step leaves behind is an event. */
static bool complete_step(instance *each, bool *event)
{
  *event = false;
  if (!is_exchanged(each, "completed integrator step") ||
      !in_phase(each, MOVING, "completed integrator step")) {
    return false;
  }
  *event = follow_motion(each);
  return true;
}

#endif
