/* Co-simulation: the model steps that fall into a communication step. */
#ifndef STEPPING_H
#define STEPPING_H

/* By how much of a model step the importer's sum of times may be off. */
#define SLACK 1e-3
/* By how much of the time since the start: two communication points that are this close are one. */
#define ROUNDING 1e-9
/* More model steps than this in one communication step are a mistake: thirty years of seconds. */
#define MOST_STEPS 1e9

/* A process moves to a time since the start, in model steps: whole steps from one multiple of the
   step to the next, and a part of one where a communication step begins or ends between two. */
static void move_to(instance_snapshot *now, double end)
{
  const double slack = fmin(SLACK, ROUNDING * (1.0 + end));
  const double whole = floor(end + slack);
  const double part = end - whole > slack ? end - whole : 0.0;
  bool shown = true;
  if (now->steps < whole && now->part > 0.0) {
    model_part(&now->memory, now->part, 1.0);
    model_complete(&now->memory);
    now->steps += 1.0;
    now->part = 0.0;
    shown = false;
  }
  while (now->steps < whole) {
    model_advance(&now->memory);
    now->steps += 1.0;
    shown = true;
  }
  if (part > now->part) {
    model_part(&now->memory, now->part, part);
    now->part = part;
    shown = false;
  }
  if (!shown) {
    model_show(&now->memory);
  }
}

/* A sampled controller runs at the start of each sampling period: in a communication step from t
   to t + length the scans run that fall due from t on and before its end, so that the outputs
   hold until the next one. A process moves through the whole communication step. */
static bool step_to(instance *each, double from, double length)
{
  char text[200];
  instance_snapshot *now = &each->now;
  double end;
  if (!in_phase(each, STEPPING, "do step")) {
    return false;
  }
  if (!(length > 0.0 && length <= DBL_MAX)) {
    return refuse(each, "do step: the communication step size is not a number above 0 s");
  }
  if (!(fabs(from - now->time) <= SLACK * MODEL_STEP)) {
    (void)snprintf(text, sizeof text,
                   "do step: the communication point is %.9g s, but the last step ended at %.9g s",
                   from, now->time);
    return refuse(each, text);
  }
  end = (from + length - now->start) / MODEL_STEP;
  if (!(end - now->steps <= MOST_STEPS)) {
    return refuse(each, "do step: the communication step size is too long");
  }
  if (!MODEL_SCANS) {
    move_to(now, end);
  } else {
    while (now->steps < ceil(end - SLACK)) {
      model_advance(&now->memory);
      now->steps += 1.0;
    }
  }
  now->time = from + length;
  return true;
}

#endif
