/* A station on Cyclone DDS: prints the catalogue and every value with a refresh of at most one
 * second, writes 42 to line/meter/setpoint, and prints the result. Enter ends it.
 * usage: station [DOMAIN] */
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dds/dds.h"
#include "fieldcast.h" /* made by idlc */

static const char* const kQualities[] = {
    "GOOD",      "UNCERTAIN",         "BAD_NO_ANSWER", "BAD_FRAME", "BAD_DEVICE_ERROR",
    "BAD_RANGE", "BAD_CONFIGURATION", "NOT_YET_READ"};
static const char* const kStates[] = {"done", "verified", "rejected", "failed", "expired"};

/* Exits on a failure. */
static dds_entity_t need(dds_entity_t entity) {
  if (entity >= 0) return entity;
  fprintf(stderr, "%s\n", dds_strretcode(entity));
  exit(1);
}

static dds_entity_t topic(dds_entity_t domain, const dds_topic_descriptor_t* type,
                          const char* name) {
  return need(dds_create_topic(domain, type, name, NULL, NULL));
}

static void print_channels(dds_entity_t reader) {
  void* taken[1] = {NULL};
  for (dds_sample_info_t info; dds_take(reader, taken, &info, 1, 1) == 1;
       dds_return_loan(reader, taken, 1)) {
    const fieldcast_Channel* c = taken[0];
    if (info.valid_data)
      printf("found %s/%s/%s: %s %s at %s\n", c->bus, c->device, c->channel, c->type, c->unit,
             c->at);
  }
}

static void print_samples(dds_entity_t reader) {
  void* taken[1] = {NULL};
  for (dds_sample_info_t info; dds_take(reader, taken, &info, 1, 1) == 1;
       dds_return_loan(reader, taken, 1)) {
    const fieldcast_Sample* s = taken[0];
    if (!info.valid_data) continue; /* the channel was removed */
    printf("%s/%s/%s ", s->bus, s->device, s->channel);
    switch (s->value._d) {
      case fieldcast_VALUE_BOOLEAN:
        printf("%s", s->value._u.boolean_value ? "true" : "false");
        break;
      case fieldcast_VALUE_INT64: printf("%" PRId64, s->value._u.int64_value); break;
      case fieldcast_VALUE_UINT64: printf("%" PRIu64, s->value._u.uint64_value); break;
      case fieldcast_VALUE_DOUBLE: printf("%g", s->value._u.double_value); break;
      case fieldcast_VALUE_STRING: printf("%s", s->value._u.string_value); break;
    }
    printf(" %s, %" PRId64 " ms old\n", kQualities[s->quality],
           (dds_time() - s->acquired_at) / 1000000);
  }
}

/* A channel had no sample within the reader's deadline. Called on a Cyclone thread. */
static void on_missed(dds_entity_t reader, const dds_requested_deadline_missed_status_t status,
                      void* context) {
  (void)context;
  static fieldcast_Sample keys;
  if (dds_instance_get_key(reader, status.last_instance_handle, &keys) == DDS_RETCODE_OK)
    printf("late: %s/%s/%s\n", keys.bus, keys.device, keys.channel);
}

/* Writes after discovery of both sides, because a late reader does not receive old results. */
static bool write_setpoint(dds_entity_t writer, dds_entity_t results, fieldcast_Command* command) {
  dds_publication_matched_status_t bridges = {0};
  dds_subscription_matched_status_t result_writers = {0};
  dds_get_publication_matched_status(writer, &bridges);
  dds_get_subscription_matched_status(results, &result_writers);
  if (bridges.current_count == 0 || result_writers.current_count == 0) return false;
  fieldcast_Value value = {._d = fieldcast_VALUE_INT64, ._u.int64_value = 42};
  snprintf(command->requester, sizeof command->requester, "my-station:%d:%" PRId64, (int)getpid(),
           dds_time()); /* unique for each run */
  command->request_id = 1;
  strcpy(command->bus, "line");
  strcpy(command->device, "meter");
  strcpy(command->target, "setpoint");
  command->operation = fieldcast_OPERATION_WRITE;
  command->encoding.bit = -1;
  command->values = (dds_sequence_fieldcast_Value){1, 1, &value, false};
  command->verify = true; /* read it back */
  need(dds_write(writer, command));
  return true;
}

/* The topic has the results of all requesters; ours has our keys. */
static void print_result(dds_entity_t reader, const fieldcast_Command* command) {
  void* taken[1] = {NULL};
  for (dds_sample_info_t info; dds_take(reader, taken, &info, 1, 1) == 1;
       dds_return_loan(reader, taken, 1)) {
    const fieldcast_CommandResult* r = taken[0];
    if (info.valid_data && r->request_id == command->request_id &&
        strcmp(r->requester, command->requester) == 0)
      printf("write: %s%s%s\n", kStates[r->state], r->reason[0] ? ": " : "", r->reason);
  }
}

int main(int argc, char** argv) {
  const dds_entity_t domain =
      need(dds_create_participant(argc > 1 ? (dds_domainid_t)atoi(argv[1]) : 0, NULL, NULL));
  dds_qos_t* state = dds_create_qos(); /* a late joiner gets the last values */
  dds_qset_reliability(state, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(state, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_entity_t channels = need(dds_create_reader(
      domain, topic(domain, &fieldcast_Channel_desc, "fieldcast/Channel"), state, NULL));
  dds_qset_deadline(state, DDS_SECS(1)); /* matches only channels that offer it */
  dds_listener_t* listener = dds_create_listener(NULL);
  dds_lset_requested_deadline_missed(listener, on_missed);
  const dds_entity_t samples = need(dds_create_reader(
      domain, topic(domain, &fieldcast_Sample_desc, "fieldcast/Sample"), state, listener));

  dds_qos_t* once = dds_create_qos(); /* commands are not kept for late joiners */
  dds_qset_reliability(once, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(once, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t results = need(dds_create_reader(
      domain, topic(domain, &fieldcast_CommandResult_desc, "fieldcast/CommandResult"), once, NULL));
  dds_qset_lifespan(once, DDS_SECS(5)); /* never started later than this */
  const dds_entity_t commands = need(dds_create_writer(
      domain, topic(domain, &fieldcast_Command_desc, "fieldcast/Command"), once, NULL));

  static fieldcast_Command command; /* zeroed */
  bool written = false;
  for (struct pollfd enter = {.fd = 0, .events = POLLIN}; poll(&enter, 1, 10) == 0;) {
    print_channels(channels);
    print_samples(samples);
    print_result(results, &command);
    if (!written) written = write_setpoint(commands, results, &command);
    fflush(stdout);
  }
  return dds_delete(domain) != 0;
}
