/* Co-simulation: the model steps that fall into a communication step. */
#ifndef STEPPING_H
#define STEPPING_H

/* By how much of a model step the importer's sum of times may be off. */
#define SLACK 1e-3
/* More model steps than this in one communication step are a mistake: thirty years of seconds. */
#define MOST_STEPS 1e9

/* A sampled controller runs at the start of each sampling period: in a communication step from t
   to t + length the scans run that fall due from t on and before its end, so that the outputs
   hold until the next one. A process moves through the whole communication step, which must be a
   multiple of its integration step. */
static bool step_to(instance *each, double from, double length)
{
  char text[200];
  instance_snapshot *now = &each->now;
  double steps, due;
  if (!in_phase(each, STEPPING, "do step")) {
    return false;
  }
  if (!(length > 0.0 && length <= DBL_MAX)) {
    return refuse(each, "do step: the communication step size is no number above 0 s");
  }
  if (!(fabs(from - now->time) <= SLACK * MODEL_STEP)) {
    (void)snprintf(text, sizeof text,
                   "do step: the communication point is %.9g s, but the last step ended at %.9g s",
                   from, now->time);
    return refuse(each, text);
  }
  steps = (from + length - now->start) / MODEL_STEP;
  if (!(steps - now->steps <= MOST_STEPS)) {
    return refuse(each, "do step: the communication step size is too long");
  }
  due = MODEL_SCANS ? ceil(steps - SLACK) : floor(steps + 0.5);
  if (!MODEL_SCANS && fabs(steps - due) > SLACK) {
    (void)snprintf(text, sizeof text,
                   "do step: the communication step size is %.9g s, but it must be a multiple of "
                   "the integration step of %.9g s", length, MODEL_STEP);
    return refuse(each, text);
  }
  while (now->steps < due) {
    model_advance(&now->memory);
    now->steps += 1.0;
  }
  now->time = from + length;
  return true;
}

#endif
