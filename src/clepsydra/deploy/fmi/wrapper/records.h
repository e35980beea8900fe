/* Copies of an instance's state, for importers that go back to one or keep it as bytes. */
#ifndef RECORDS_H
#define RECORDS_H

/* What a state looks like outside the instance: it is taken back by the same model only. */
typedef struct {
  char token[sizeof MODEL_TOKEN];
  instance_snapshot state;
} instance_record;

static instance_record *record_of(const instance *each, instance_record *record)
{
  if (record == NULL) {
    record = calloc(1, sizeof *record);
  }
  if (record == NULL) {
    refuse(each, "get state: there is not enough memory");
    return NULL;
  }
  memcpy(record->token, MODEL_TOKEN, sizeof record->token);
  record->state = each->now;
  return record;
}

static bool is_record(const instance *each, const instance_record *record)
{
  if (record != NULL && memcmp(record->token, MODEL_TOKEN, sizeof record->token) == 0) {
    return true;
  }
  return refuse(each, "set state: this is no state of this model");
}

static bool fits_record(const instance *each, size_t size)
{
  if (size == sizeof(instance_record)) {
    return true;
  }
  return refuse(each, "serialised state: it has another size than a state of this model");
}

static instance_record *read_record(const instance *each, const void *bytes, size_t size)
{
  instance_record *record;
  if (!fits_record(each, size)) {
    return NULL;
  }
  record = malloc(sizeof *record);
  if (record == NULL) {
    refuse(each, "deserialise state: there is not enough memory");
    return NULL;
  }
  memcpy(record, bytes, sizeof *record);
  if (!is_record(each, record)) {
    free(record);
    return NULL;
  }
  return record;
}

static bool go_back(instance *each, const instance_record *record)
{
  if (!is_record(each, record)) {
    return false;
  }
  each->now = record->state;
  return true;
}

static bool write_record(const instance *each, const instance_record *record, void *bytes,
                         size_t size)
{
  if (!is_record(each, record) || !fits_record(each, size)) {
    return false;
  }
  memcpy(bytes, record, size);
  return true;
}

static void free_record(void **record)
{
  if (record != NULL) {
    free(*record);
    *record = NULL;
  }
}

#endif
