#include "station.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static volatile sig_atomic_t stop_asked = 0;

static void ask_to_stop(int number) {
  (void)number;
  stop_asked = 1;
}

bool stopped(void) {
  static bool listening = false;
  if (!listening) {
    signal(SIGTERM, ask_to_stop);
    signal(SIGINT, ask_to_stop);
    listening = true;
  }
  return stop_asked != 0;
}

dds_entity_t need(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(entity));
    exit(1);
  }
  return entity;
}

dds_entity_t participant_in(const char* domain) {
  return need(dds_create_participant((dds_domainid_t)atoi(domain), NULL, NULL), "participant");
}

static dds_entity_t topic_of(dds_entity_t participant, const dds_topic_descriptor_t* type,
                             const char* name) {
  return need(dds_create_topic(participant, type, name, NULL, NULL), name);
}

dds_entity_t reader_of(dds_entity_t participant, const dds_topic_descriptor_t* type,
                       const char* name, const dds_qos_t* qos) {
  return need(dds_create_reader(participant, topic_of(participant, type, name), qos, NULL), name);
}

dds_entity_t writer_of(dds_entity_t participant, const dds_topic_descriptor_t* type,
                       const char* name, const dds_qos_t* qos) {
  return need(dds_create_writer(participant, topic_of(participant, type, name), qos, NULL), name);
}

void set_write(fieldcast_Command* command, char** names, fieldcast_Value* value) {
  snprintf(command->requester, sizeof command->requester, "cyclone:%d:%" PRId64, (int)getpid(),
           dds_time());
  snprintf(command->bus, sizeof command->bus, "%s", names[0]);
  snprintf(command->device, sizeof command->device, "%s", names[1]);
  command->target_kind = fieldcast_TARGET_CHANNEL;
  snprintf(command->target, sizeof command->target, "%s", names[2]);
  command->encoding.bit = -1;
  command->operation = fieldcast_OPERATION_WRITE;
  command->values = (dds_sequence_fieldcast_Value){
      ._maximum = 1, ._length = 1, ._buffer = value, ._release = false};
}

bool matched(dds_entity_t writer, dds_entity_t reader, dds_time_t until) {
  for (; dds_time() < until; dds_sleepfor(DDS_MSECS(10))) {
    dds_publication_matched_status_t published = {0};
    dds_subscription_matched_status_t subscribed = {0};
    dds_get_publication_matched_status(writer, &published);
    dds_get_subscription_matched_status(reader, &subscribed);
    if (published.current_count > 0 && subscribed.current_count > 0) return true;
  }
  return false;
}

dds_qos_t* state_qos(dds_duration_t deadline) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  if (deadline > 0) dds_qset_deadline(qos, deadline);
  return qos;
}

dds_qos_t* request_qos(void) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  return qos;
}

const char* quality_name(fieldcast_Quality quality) {
  static const char* const names[] = {
      "GOOD",      "UNCERTAIN",         "BAD_NO_ANSWER", "BAD_FRAME", "BAD_DEVICE_ERROR",
      "BAD_RANGE", "BAD_CONFIGURATION", "NOT_YET_READ"};
  return (unsigned)quality < sizeof names / sizeof *names ? names[quality] : "?";
}

const char* state_name(fieldcast_CommandState state) {
  static const char* const names[] = {"DONE", "VERIFIED", "REJECTED", "FAILED", "EXPIRED"};
  return (unsigned)state < sizeof names / sizeof *names ? names[state] : "?";
}

const char* kind_name(fieldcast_ValueKind kind) {
  static const char* const names[] = {"boolean", "int64", "uint64", "double", "string"};
  return (unsigned)kind < sizeof names / sizeof *names ? names[kind] : "?";
}

void print_value(const fieldcast_Value* value) {
  switch (value->_d) {
    case fieldcast_VALUE_BOOLEAN: printf("%s", value->_u.boolean_value ? "true" : "false"); break;
    case fieldcast_VALUE_INT64: printf("%" PRId64, value->_u.int64_value); break;
    case fieldcast_VALUE_UINT64: printf("%" PRIu64, value->_u.uint64_value); break;
    case fieldcast_VALUE_DOUBLE: printf("%.17g", value->_u.double_value); break;
    case fieldcast_VALUE_STRING: printf("%s", value->_u.string_value); break;
  }
}
