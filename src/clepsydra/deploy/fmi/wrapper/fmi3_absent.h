/* Functions of the Functional Mock-up Interface 3.0 that these models have no use for: they are
   there, and say so. Included at the end of fmi3.c. */
#ifndef FMI3_ABSENT_H
#define FMI3_ABSENT_H

/* Scheduled execution, step mode, and discrete states apart from their update. */

EXPORTED fmi3Instance NAMED(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
  const instance plain = {.environment = environment, .logger = (void (*)(void))logger};
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update;
  (void)lock, (void)unlock;
  refuse(&plain, "instantiate scheduled execution: this model has no clocks");
  return NULL;
}

FUNCTION(fmi3EnterStepMode)(fmi3Instance each)
{
  return absent(each, "fmi3EnterStepMode");
}

FUNCTION(fmi3GetOutputDerivatives)(fmi3Instance each, const fmi3ValueReference references[],
                                   size_t count, const fmi3Int32 orders[], fmi3Float64 values[],
                                   size_t size)
{
  (void)references, (void)orders, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetOutputDerivatives");
}

FUNCTION(fmi3EvaluateDiscreteStates)(fmi3Instance each)
{
  return absent(each, "fmi3EvaluateDiscreteStates");
}

/* Values of other types. */

#define NO_ACCESS(type, c_type)                                                                  \
  FUNCTION(fmi3Get##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, c_type values[], size_t size)                            \
  {                                                                                              \
    (void)references, (void)values, (void)size;                                                  \
    return count == 0 ? fmi3OK : absent(each, "fmi3Get" #type);                                  \
  }                                                                                              \
  FUNCTION(fmi3Set##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, const c_type values[], size_t size)                      \
  {                                                                                              \
    (void)references, (void)values, (void)size;                                                  \
    return count == 0 ? fmi3OK : absent(each, "fmi3Set" #type);                                  \
  }

NO_ACCESS(Float32, fmi3Float32)
NO_ACCESS(Int8, fmi3Int8)
NO_ACCESS(UInt8, fmi3UInt8)
NO_ACCESS(Int16, fmi3Int16)
NO_ACCESS(UInt16, fmi3UInt16)
NO_ACCESS(UInt32, fmi3UInt32)
NO_ACCESS(Int64, fmi3Int64)
NO_ACCESS(UInt64, fmi3UInt64)
NO_ACCESS(String, fmi3String)

FUNCTION(fmi3GetBinary)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                        size_t sizes[], fmi3Binary values[], size_t size)
{
  (void)references, (void)sizes, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetBinary");
}

FUNCTION(fmi3SetBinary)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                        const size_t sizes[], const fmi3Binary values[], size_t size)
{
  (void)references, (void)sizes, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3SetBinary");
}

FUNCTION(fmi3GetClock)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                       fmi3Clock values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetClock");
}

FUNCTION(fmi3SetClock)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                       const fmi3Clock values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi3OK : absent(each, "fmi3SetClock");
}

/* Clocks, partial derivatives and structural parameters: none. */

FUNCTION(fmi3GetNumberOfVariableDependencies)(fmi3Instance each, fmi3ValueReference reference,
                                              size_t *count)
{
  (void)reference, (void)count;
  return absent(each, "fmi3GetNumberOfVariableDependencies");
}

FUNCTION(fmi3GetVariableDependencies)(fmi3Instance each, fmi3ValueReference dependent,
                                      size_t places[], fmi3ValueReference independents[],
                                      size_t independent_places[], fmi3DependencyKind kinds[],
                                      size_t count)
{
  (void)dependent, (void)places, (void)independents, (void)independent_places, (void)kinds;
  (void)count;
  return absent(each, "fmi3GetVariableDependencies");
}

#define NO_DERIVATIVE(name)                                                                      \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference unknowns[], size_t unknown_count,   \
                 const fmi3ValueReference knowns[], size_t known_count,                          \
                 const fmi3Float64 seed[], size_t seed_size, fmi3Float64 sensitivity[],          \
                 size_t sensitivity_size)                                                        \
  {                                                                                              \
    (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed;            \
    (void)seed_size, (void)sensitivity, (void)sensitivity_size;                                  \
    return absent(each, #name);                                                                  \
  }

NO_DERIVATIVE(fmi3GetDirectionalDerivative)
NO_DERIVATIVE(fmi3GetAdjointDerivative)

FUNCTION(fmi3EnterConfigurationMode)(fmi3Instance each)
{
  return absent(each, "fmi3EnterConfigurationMode");
}

FUNCTION(fmi3ExitConfigurationMode)(fmi3Instance each)
{
  return absent(each, "fmi3ExitConfigurationMode");
}

FUNCTION(fmi3GetIntervalDecimal)(fmi3Instance each, const fmi3ValueReference references[],
                                 size_t count, fmi3Float64 intervals[],
                                 fmi3IntervalQualifier qualifiers[])
{
  (void)references, (void)count, (void)intervals, (void)qualifiers;
  return absent(each, "fmi3GetIntervalDecimal");
}

FUNCTION(fmi3GetIntervalFraction)(fmi3Instance each, const fmi3ValueReference references[],
                                  size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                  fmi3IntervalQualifier qualifiers[])
{
  (void)references, (void)count, (void)counters, (void)resolutions, (void)qualifiers;
  return absent(each, "fmi3GetIntervalFraction");
}

#define NO_DECIMAL(name, c_type)                                                                 \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference references[], size_t count,         \
                 c_type values[])                                                                \
  {                                                                                              \
    (void)references, (void)count, (void)values;                                                 \
    return absent(each, #name);                                                                  \
  }

NO_DECIMAL(fmi3GetShiftDecimal, fmi3Float64)
NO_DECIMAL(fmi3SetShiftDecimal, const fmi3Float64)
NO_DECIMAL(fmi3SetIntervalDecimal, const fmi3Float64)

#define NO_FRACTION(name, c_type)                                                                \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference references[], size_t count,         \
                 c_type counters[], c_type resolutions[])                                        \
  {                                                                                              \
    (void)references, (void)count, (void)counters, (void)resolutions;                            \
    return absent(each, #name);                                                                  \
  }

NO_FRACTION(fmi3GetShiftFraction, fmi3UInt64)
NO_FRACTION(fmi3SetShiftFraction, const fmi3UInt64)
NO_FRACTION(fmi3SetIntervalFraction, const fmi3UInt64)

FUNCTION(fmi3ActivateModelPartition)(fmi3Instance each, fmi3ValueReference clock,
                                     fmi3Float64 time)
{
  (void)clock, (void)time;
  return absent(each, "fmi3ActivateModelPartition");
}

#endif
