/* From one phase of an instance's life to the next. */
#ifndef PHASES_H
#define PHASES_H

static bool begin(instance *each, double start)
{
  if (!in_phase(each, INSTANTIATED, "enter initialization mode")) {
    return false;
  }
  if (!(fabs(start) <= DBL_MAX)) {
    return refuse(each, "enter initialization mode: the start time is not a number");
  }
  each->now.start = start;
  each->now.time = start;
  each->now.phase = INITIALISING;
  return true;
}

static bool end_initialisation(instance *each)
{
  if (!in_phase(each, INITIALISING, "exit initialization mode")) {
    return false;
  }
  refresh(each);
  if (MODEL_EXCHANGE) {
    keep_memories(each);
    (void)follow_motion(each); /* a stem stands where its actuator starts */
  }
  each->now.phase = MODEL_EXCHANGE ? EVENTS : STEPPING;
  return true;
}

static bool change_phase(instance *each, instance_phase from, instance_phase to,
                         const char *function)
{
  if (!is_exchanged(each, function) || !in_phase(each, from, function)) {
    return false;
  }
  each->now.phase = to;
  return true;
}

static bool end_run(instance *each)
{
  if (each->now.phase == INSTANTIATED || each->now.phase == TERMINATED) {
    return refuse(each, "terminate: nothing is running");
  }
  each->now.phase = TERMINATED;
  return true;
}

#endif
